--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A call through a value of an access type of the run-time, on the line of a dispatching one

with Ada.Real_Time; use Ada.Real_Time;
with Handlers;
with Devices.Kinds; use Devices, Devices.Kinds;

procedure Fired with Priority => 12 is
   Next : Time := Clock + Milliseconds (20);
begin
   loop
      delay until Next;
      Start (This_Device.all); Handlers.Handler.all;
      Next := Next + Milliseconds (4);
   end loop;
end Fired;
