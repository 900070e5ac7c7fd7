--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  An operation of an interface

with Ada.Real_Time; use Ada.Real_Time;
with Devices.Kinds; use Devices, Devices.Kinds;

procedure Signals with Priority => 12 is
   Next  : Time := Clock + Milliseconds (20);
   Count : Natural := 0 with Volatile;
begin
   loop
      delay until Next;
      Count := (Count + 1) mod 50;
      Send (This_Signal.all);
      Next := Next + Milliseconds (4);
   end loop;
end Signals;
