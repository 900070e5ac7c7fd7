--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Calls of two types on one line

with Pace;
with Devices.Kinds; use Devices, Devices.Kinds;

procedure One_Line with Priority => 12 is
begin
   loop
      delay until Pace.Next;
      This_Meter := (if Pace.Count = 7 then A_Slow'Access else A_Lamp'Access);
      Read (This_Meter.all); Start (This_Device.all);
   end loop;
end One_Line;
