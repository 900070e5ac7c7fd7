--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  No_Select_Statements

package body Select_Statement is

   protected body Object is
      entry First when Open is
      begin
         Open := False;
      end First;
   end Object;

   procedure Try is
   begin
      select
         Object.First;
      else
         null;
      end select;
   end Try;

end Select_Statement;
