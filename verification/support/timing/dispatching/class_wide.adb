--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A class-wide parameter of a unit that sees none of the types

with Pace;
with Devices.Kinds; use Devices, Devices.Kinds;

procedure Class_Wide with Priority => 12 is
begin
   loop
      delay until Pace.Next;
      This_Device := (if Pace.Count = 7 then A_Longest'Access else A_Short'Access);
      Run (This_Device.all);
   end loop;
end Class_Wide;
