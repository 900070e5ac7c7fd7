--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Calls of two types on one line

with Ada.Real_Time; use Ada.Real_Time;
with Devices.Kinds; use Devices, Devices.Kinds;

procedure One_Line with Priority => 12 is
   Next  : Time := Clock + Milliseconds (20);
   Count : Natural := 0 with Volatile;
begin
   loop
      delay until Next;
      Count := (Count + 1) mod 50;
      This_Meter := (if Count = 7 then A_Slow'Access else A_Lamp'Access);
      Read (This_Meter.all); Start (This_Device.all);
      Next := Next + Milliseconds (4);
   end loop;
end One_Line;
