--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A light sensor on port 3 with its lamp on: how bright the ground is.

with Ada.Real_Time;            use Ada.Real_Time;
with NXT.AVR;
with NXT.Display;              use NXT.Display;
with NXT.Light_Sensors;        use NXT.Light_Sensors;
with NXT.Light_Sensors.Ctors;  use NXT.Light_Sensors.Ctors;

procedure Light is

   use NXT;

   Eye  : constant Light_Sensor := Make (Sensor_3, Floodlight_On => True);
   Next : Time;
begin
   NXT.AVR.Await_Data_Available;
   Put_At (0, 0, "brightness     %");
   Next := Clock + Milliseconds (20);
   loop
      delay until Next;
      Set_Pos (11, 0);
      Put (Eye.Brightness, Width => 4);
      Next := Next + Milliseconds (100);
   end loop;
end Light;
