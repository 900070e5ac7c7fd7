--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A call through a value of an access type of the run-time, on the line of a dispatching one

with Pace;
with Handlers;
with Devices.Kinds; use Devices, Devices.Kinds;

procedure Fired with Priority => 12 is
begin
   loop
      delay until Pace.Next;
      Start (This_Device.all); Handlers.Handler.all;
   end loop;
end Fired;
