--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  No_Abort_Statements

package body Abort_Statement is

   task body Victim is
   begin
      loop
         null;
      end loop;
   end Victim;

   procedure Kill is
   begin
      abort Victim;
   end Kill;

end Abort_Statement;
