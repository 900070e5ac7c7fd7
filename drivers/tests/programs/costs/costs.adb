--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  One operation of a driver every 100 ms, in the order of cost_table.py's list.

with Ada.Real_Time;                 use Ada.Real_Time;
with NXT.Audio;
with NXT.AVR;
with NXT.Battery;
with NXT.Display;                   use NXT.Display;
with NXT.Light_Sensors.Ctors;       use NXT.Light_Sensors, NXT.Light_Sensors.Ctors;
with NXT.Motor_Controls;            use NXT.Motor_Controls;
with NXT.Motor_Encoders;
with NXT.Sound_Sensors.Ctors;       use NXT.Sound_Sensors, NXT.Sound_Sensors.Ctors;
with NXT.Touch_Sensors;             use NXT.Touch_Sensors;
with NXT.Ultrasonic_Sensors.Ctors;  use NXT.Ultrasonic_Sensors, NXT.Ultrasonic_Sensors.Ctors;

procedure Costs is

   use NXT;

   Operations : Integer := 17 with
     Volatile, Export, Convention => C, External_Name => "operations";

   Number   : Integer with Volatile;
   Touched  : Boolean with Volatile;
   Bumper   : Touch_Sensor (Sensor_1);
   Eye      : Light_Sensor := Make (Sensor_2, Floodlight_On => True);
   Ear      : constant Sound_Sensor := Make (Sensor_3, DBA_Mode => False);
   Sonar    : Ultrasonic_Sensor := Make (Sensor_4);
   Reading  : NXT.Motor_Encoders.Reading;
   Distance : Centimetres;
   Status   : Measurement_Status;

   procedure Perform (Operation : Positive) is
   begin
      case Operation is
         when 2      => Number := NXT.Motor_Encoders.Encoder_Count (Motor_A);
         when 3      => Reading := NXT.Motor_Encoders.Current;
         when 4      => Drive (Motor_B, 50);
         when 5      => Touched := Pressed (Bumper);
         when 6      => Number := Integer (NXT.AVR.Raw_Input (Sensor_1));
         when 7      => Number := Eye.Light_Value;
         when 8      => Eye.Enable_Floodlight (False);
         when 9      => Number := Ear.Sound_Level;
         when 10     => Number := Integer (NXT.Battery.Voltage);
         when 11     => Put_Noupdate ("sixteen letters.");
         when 12     => Put_Noupdate (Integer'(-12_345));
         when 13     => Screen_Update;
         when 14     => Sonar.Measure (Distance, Status);
         when 15     => NXT.Audio.Play_Tone (440, 20, 100);
         when 16     => Number := NXT.Audio.Time_Remaining;
         when others => null;
      end case;
   end Perform;

   Next : Time := NXT.AVR.First_Release + Milliseconds (501);
begin
   Sonar.Measure (Distance, Status);
   for Operation in 1 .. Operations loop
      delay until Next;
      Perform (Operation);
      Next := Next + Milliseconds (100);
   end loop;
   pragma Unreferenced (Touched, Reading);
   delay until Time_Last;
end Costs;
