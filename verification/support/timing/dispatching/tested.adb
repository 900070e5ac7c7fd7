--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A subprogram at an address from a table, which is looked at before as by the compiler

with System.Storage_Elements; use System.Storage_Elements;
with Places;
with Pace;
with Devices.Kinds; use Devices, Devices.Kinds;

procedure Tested with Priority => 12 is
begin
   loop
      delay until Pace.Next;
      Start (This_Device.all);
      declare
         Place : constant Integer_Address := Places.This_Table (1);
         procedure Elsewhere (Steps : Positive) with Import, Address => To_Address (Place);
      begin
         if (Place and 2) = 0 then
            Work_Done := Work_Done + 1;
            Work_Done := Work_Done / 3;
            Elsewhere (5);
         end if;
      end;
   end loop;
end Tested;
