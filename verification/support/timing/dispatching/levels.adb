--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  An operation that is inherited over two levels, in a nested package, with a name of its own; and
--  a null procedure that nobody overrides

with Ada.Real_Time; use Ada.Real_Time;
with Devices.Kinds; use Devices, Devices.Kinds;

procedure Levels with Priority => 12 is
   Next  : Time := Clock + Milliseconds (20);
   Count : Natural := 0 with Volatile;
begin
   loop
      delay until Next;
      Count := (Count + 1) mod 50;
      This_Device := (if Count = 7 then A_Longest'Access else A_Short'Access);
      Start (This_Device.all);
      Rest (This_Device.all);
      Next := Next + Milliseconds (4);
   end loop;
end Levels;
