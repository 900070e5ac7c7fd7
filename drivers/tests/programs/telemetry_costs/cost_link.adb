--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body Cost_Link is

   use NXT.Telemetry;

   procedure Declare_Group (Group : Group_Id; Count : Positive) is
   begin
      for Number in 1 .. Count loop
         Declare_Signal (Group, "signal", "V", Real);
      end loop;
   end Declare_Group;

begin
   Declare_Group (1, 1);
   Declare_Group (2, 4);
   Declare_Group (3, 8);
end Cost_Link;
