--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  No_Requeue_Statements

package body Requeue_Statement is

   protected body Object is
      entry First when Open is
      begin
         requeue First;
      end First;
   end Object;

end Requeue_Statement;
