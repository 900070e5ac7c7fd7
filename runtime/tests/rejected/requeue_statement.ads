--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package Requeue_Statement is

   protected Object is
      entry First;
   private
      Open : Boolean := False;
   end Object;

end Requeue_Statement;
