--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A class-wide parameter of a unit that sees none of the types

with Ada.Real_Time; use Ada.Real_Time;
with Devices.Kinds; use Devices, Devices.Kinds;

procedure Class_Wide with Priority => 12 is
   Next  : Time := Clock + Milliseconds (20);
   Count : Natural := 0 with Volatile;
begin
   loop
      delay until Next;
      Count := (Count + 1) mod 50;
      This_Device := (if Count = 7 then A_Longest'Access else A_Short'Access);
      Run (This_Device.all);
      Next := Next + Milliseconds (4);
   end loop;
end Class_Wide;
