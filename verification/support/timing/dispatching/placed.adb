--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A subprogram at an address that is read from memory, beside a dispatching call

with Places;
with Ada.Real_Time; use Ada.Real_Time;
with Devices.Kinds; use Devices, Devices.Kinds;

procedure Placed with Priority => 12 is
   Next  : Time := Clock + Milliseconds (20);
   Count : Natural := 0 with Volatile;
   procedure Elsewhere (Steps : Positive) with Import, Address => Places.Place;
begin
   loop
      delay until Next;
      Count := (Count + 1) mod 50;
      Start (This_Device.all);
      Elsewhere (5);
      Next := Next + Milliseconds (4);
   end loop;
end Placed;
