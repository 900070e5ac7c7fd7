--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Encoders while everything else is busy: link, display, sound, an ultrasonic sensor, tasks.

with Ada.Real_Time;                 use Ada.Real_Time;
with NXT.Audio;                     use NXT.Audio;
with NXT.Display;                   use NXT.Display;
with NXT.Motor_Encoders;            use NXT.Motor_Encoders;
with NXT.Ultrasonic_Sensors.Ctors;  use NXT.Ultrasonic_Sensors, NXT.Ultrasonic_Sensors.Ctors;

procedure Encoder_Stress is

   use NXT;

   Count_A : Integer := 0 with Volatile, Export, Convention => C, External_Name => "count_a";
   Count_B : Integer := 0 with Volatile, Export, Convention => C, External_Name => "count_b";
   Count_C : Integer := 0 with Volatile, Export, Convention => C, External_Name => "count_c";
   Rounds  : Integer := 0 with Volatile, Export, Convention => C, External_Name => "rounds";

   Sonar    : Ultrasonic_Sensor := Make (Sensor_4);
   Distance : Centimetres;
   Status   : Measurement_Status;
   Now      : Reading;
begin
   loop
      Play_Tone (2_000, 500, 80);
      Sonar.Measure (Distance, Status);
      for Frame in 1 .. 10 loop
         Now := Current;
         Count_A := Now.Counts (Motor_A);
         Count_B := Now.Counts (Motor_B);
         Count_C := Now.Counts (Motor_C);
         Set_Pos (0, 0);
         for Motor in Motor_Id loop
            Put_Noupdate (Now.Counts (Motor), Width => 8);
            New_Line;
         end loop;
         delay until Clock + Milliseconds (5);
      end loop;
      Rounds := Rounds + 1;
   end loop;
   pragma Unreferenced (Distance, Status);
end Encoder_Stress;
