--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Controller_Design;  use Controller_Design;
with Live;
with NXT.AVR;
with NXT.Battery;
with NXT.Buttons;
with NXT.Motor_Controls;
with NXT.Motor_Encoders;
with NXT.Telemetry;
with NXT.Shared_State;
with NXT.Touch_Sensors;
with Speed_Controller;
with System;

package body Bench is

   use NXT;

   Target_Angle : constant := 360;
   Fastest      : constant := 5.0;
   --  Degrees, and the largest set-point that the outer loop gives.

   Sensor  : NXT.Touch_Sensors.Touch_Sensor (Sensor_1);
   Touched : Boolean := True;

   package Shared is new NXT.Shared_State (Status, Ceiling => System.Priority'First + 2);

   --  Symbols for an observer; the program only writes them

   Setpoint_Seen : Float := 0.0 with
     Volatile, Export, Convention => C, External_Name => "bench_setpoint";
   Speed_Seen    : Float := 0.0 with
     Volatile, Export, Convention => C, External_Name => "bench_speed";
   Control_Seen  : Float := 0.0 with
     Volatile, Export, Convention => C, External_Name => "bench_control";

   --  Angles of the last periods

   subtype Reading_Index is Natural range 0 .. Speed_Window - 1;
   Past   : array (Reading_Index) of Integer := (others => 0);
   Oldest : Reading_Index := 0;

   Now    : Status;
   Origin : Integer := 0;
   Work   : Speed_Controller.Work_Area;

   procedure Start is
   begin
      Past := (others => NXT.Motor_Encoders.Encoder_Count (Motor_B));
   end Start;

   procedure Measure is
      Per_Count : constant := 1000.0 / (Sample_Time_Ms * Speed_Window) / Speed_Per_Volt;
      Count     : constant Integer := NXT.Motor_Encoders.Encoder_Count (Motor_B);
   begin
      Now.Speed := Float (Count - Past (Oldest)) * Per_Count;
      Now.Angle := Count - Origin;
      Past (Oldest) := Count;
      Oldest := (Oldest + 1) mod Speed_Window;
   end Measure;

   procedure Read_Touch_Sensor is
      Touched_Now : constant Boolean := NXT.Touch_Sensors.Pressed (Sensor);
   begin
      if Touched_Now and then not Touched then
         if Now.Mode /= Stopped then
            Now := (Angle => Now.Angle, Speed => Now.Speed, others => <>);
            NXT.Motor_Controls.Brake (Motor_B);
         else
            Speed_Controller.Initialize (Work);
            Origin := Origin + Now.Angle;
            Now.Mode :=
              (if NXT.Buttons.Current_Button = Left_Button then Position else Speed);
         end if;
      end if;
      Touched := Touched_Now;
   end Read_Touch_Sensor;

   function Outer_Loop return Float is
      Wanted : constant Float :=
        Position_Gain * Float (Target_Angle - Now.Angle) * (1.0 / Speed_Per_Volt);
   begin
      return Float'Max (-Fastest, Float'Min (Fastest, Wanted));
   end Outer_Loop;

   procedure Drive is
      Supply  : constant Float := Float (NXT.Battery.Voltage) * 0.001;
      Outputs : Speed_Controller.External_Outputs;
   begin
      Now.Setpoint :=
        (if Now.Mode = Position then Outer_Loop else NXT.Telemetry.Current (Live.Setpoint));
      Live.Adopt;
      Speed_Controller.Parameters.Saturation := Supply;
      Speed_Controller.Step (Work, (Now.Setpoint, Now.Speed), Outputs);
      Now.Control := Outputs.Corrected_Voltage;
      NXT.Motor_Controls.Drive (Motor_B, PWM_Value (100.0 * Now.Control / Supply));
   end Drive;

   procedure Control is
   begin
      Measure;
      if NXT.AVR.Data_Available then
         Read_Touch_Sensor;
         if Now.Mode /= Stopped then
            Drive;
         end if;
      end if;
      Setpoint_Seen := Now.Setpoint;
      Speed_Seen := Now.Speed;
      Control_Seen := Now.Control;
      Shared.Set (Now);
      Live.Publish (Now.Setpoint, Now.Speed, Now.Control, Now.Angle);
   end Control;

   function Latest return Status is (Shared.Get);

end Bench;
