--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The compiler joins calls of two types in one instruction, which has the line of one of them.

with Pace;
with Devices.Kinds; use Devices, Devices.Kinds;

procedure Joined with Priority => 12 is
begin
   loop
      delay until Pace.Next;
      This_Meter := (if Pace.Count = 7 then A_Slow'Access else A_Lamp'Access);
      if Pace.Count mod 7 = 0 then
         Read (This_Meter.all);
      else
         Start (This_Device.all);
      end if;
   end loop;
end Joined;
