--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The compiler joins calls of two types in one instruction, which has the line of one of them.

with Ada.Real_Time; use Ada.Real_Time;
with Devices.Kinds; use Devices, Devices.Kinds;

procedure Joined with Priority => 12 is
   Next  : Time := Clock + Milliseconds (20);
   Count : Natural := 0 with Volatile;
begin
   loop
      delay until Next;
      Count := (Count + 1) mod 50;
      This_Meter := (if Count = 7 then A_Slow'Access else A_Lamp'Access);
      if Count mod 7 = 0 then
         Read (This_Meter.all);
      else
         Start (This_Device.all);
      end if;
      Next := Next + Milliseconds (4);
   end loop;
end Joined;
