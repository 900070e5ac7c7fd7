--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Controller_Design;
with NXT.AVR;
with NXT.Battery;
with NXT.Motor_Controls;
with NXT.Motor_Encoders;
with NXT.Shared_State;
with State_Feedback;
with System;

package body Balance is

   package Shared is new NXT.Shared_State (Status, Ceiling => System.Priority'First + 2);

   use NXT;

   Gyro    : constant Sensor_Id := Sensor_4;
   Radians : constant := 3.14159_26536 / 180.0;

   Calibration_Jobs : constant := 1000 / Controller_Design.Sample_Time_Ms;

   Rest_Share : constant := 0.999;
   --  While it stands the mean rate is zero, so the rest value may follow slowly (NXTway-GS).

   Sync_Gain : constant := 0.35;
   --  Per cent of duty per degree that the wheels differ: keeps the heading (NXTway-GS).

   Fallen_Pitch : constant := 0.8;

   Pitch_Seen : Float := 0.0 with
     Volatile, Export, Convention => C, External_Name => "balance_pitch";
   Mode_Seen  : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "balance_mode";
   --  Symbols for an observer; the program only writes them.

   Now  : Status;
   Work : State_Feedback.Work_Area;
   Jobs : Natural := 0;
   Sum  : Natural := 0;

   procedure Calibrate is
   begin
      Jobs := Jobs + 1;
      Sum := Sum + Natural (NXT.AVR.Raw_Input (Gyro));
      if Jobs = Calibration_Jobs then
         Now.Rest := Float (Sum) / Float (Jobs);
         State_Feedback.Initialize (Work);
         Now.Mode := Balancing;
      end if;
   end Calibrate;

   function To_Duty (Per_Cent : Float) return PWM_Value is
     (if Per_Cent >= 100.0 then PWM_Value'Last
      elsif Per_Cent <= -100.0 then PWM_Value'First
      else PWM_Value (Per_Cent));

   procedure Stand is
      Raw     : constant Float := Float (NXT.AVR.Raw_Input (Gyro));
      Supply  : constant Float := Float (NXT.Battery.Voltage) * 0.001;
      Reading : constant NXT.Motor_Encoders.Reading := NXT.Motor_Encoders.Current;
      Left    : constant Float := Float (Reading.Counts (Motor_B));
      Right   : constant Float := Float (Reading.Counts (Motor_C));
      Sync    : constant Float := Sync_Gain * (Left - Right);
      Outputs : State_Feedback.External_Outputs;
      Duty    : Float;
   begin
      Now.Rest := Rest_Share * Now.Rest + (1.0 - Rest_Share) * Raw;
      State_Feedback.Parameters.Saturation := Supply;
      State_Feedback.Step
        (Work, ((Left + Right) * (Radians / 2.0), (Raw - Now.Rest) * Radians), Outputs);
      Now.Motor_Voltage := Outputs.Motor_Voltage;
      Now.Pitch := Outputs.Body_Pitch;
      Duty := 100.0 * Now.Motor_Voltage / Supply;
      NXT.Motor_Controls.Drive (Motor_B, To_Duty (Duty - Sync));
      NXT.Motor_Controls.Drive (Motor_C, To_Duty (Duty + Sync));
      if abs Now.Pitch > Fallen_Pitch then
         NXT.Motor_Controls.Brake_All;
         Now.Mode := Fallen;
      end if;
   end Stand;

   procedure Control is
   begin
      if NXT.AVR.Data_Available then
         case Now.Mode is
            when Calibrating => Calibrate;
            when Balancing   => Stand;
            when Fallen      => null;
         end case;
      end if;
      Pitch_Seen := Now.Pitch;
      Mode_Seen := Modes'Pos (Now.Mode);
      Shared.Set (Now);
   end Control;

   function Latest return Status is (Shared.Get);

end Balance;
