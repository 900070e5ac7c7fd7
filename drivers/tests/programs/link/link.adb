--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Motor B is commanded once at 200 ms, motor C every 10 ms: they differ after a loss of the link.

with Ada.Real_Time;       use Ada.Real_Time;
with NXT.AVR;
with NXT.Motor_Controls;  use NXT.Motor_Controls;

procedure Link is

   use NXT;

   Errors : Integer := -1 with Volatile, Export, Convention => C, External_Name => "errors";
   Losses : Integer := -1 with Volatile, Export, Convention => C, External_Name => "losses";
   Sensor : Integer := -1 with Volatile, Export, Convention => C, External_Name => "sensor";

   Next : Time := NXT.AVR.First_Release + Milliseconds (200);
begin
   delay until Next;
   Drive (Motor_B, 60);
   loop
      Drive (Motor_C, 40);
      Errors := Integer (NXT.AVR.Link_Errors);
      Losses := Integer (NXT.AVR.Link_Losses);
      Sensor := Integer (NXT.AVR.Raw_Input (Sensor_2));
      Next := Next + Milliseconds (10);
      delay until Next;
   end loop;
end Link;
