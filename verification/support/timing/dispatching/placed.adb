--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A subprogram at an address that is read from memory, beside a dispatching call

with Places;
with Pace;
with Devices.Kinds; use Devices, Devices.Kinds;

procedure Placed with Priority => 12 is
   procedure Elsewhere (Steps : Positive) with Import, Address => Places.Place;
begin
   loop
      delay until Pace.Next;
      Start (This_Device.all);
      Elsewhere (5);
   end loop;
end Placed;
