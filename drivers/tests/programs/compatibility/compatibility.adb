--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Every operation that GNAT GPL for MINDSTORMS had, called as its programs call it: with its
--  names, its order of parameters and its types. What comes of it is looked at from outside.

with Ada.Real_Time;                 use Ada.Real_Time;
with Interfaces;                    use Interfaces;
with NXT;                           use NXT;
with NXT.Audio;                     use NXT.Audio;
with NXT.Audio.Wav;                 use NXT.Audio.Wav;
with NXT.AVR;                       use NXT.AVR;
with NXT.Battery;                   use NXT.Battery;
with NXT.Buttons;                   use NXT.Buttons;
with NXT.Display;                   use NXT.Display;
with NXT.Display.Concurrent;
with NXT.Filtering;
with NXT.Fonts;                     use NXT.Fonts;
with NXT.Graph;
with NXT.I2C_Ports;
with NXT.LCD;                       use NXT.LCD;
with NXT.Last_Chance;
pragma Unreferenced (NXT.Last_Chance);
with NXT.Light_Sensors;             use NXT.Light_Sensors;
with NXT.Light_Sensors.Ctors;       use NXT.Light_Sensors.Ctors;
with NXT.Motor_Controls;            use NXT.Motor_Controls;
with NXT.Motor_Encoders;            use NXT.Motor_Encoders;
with NXT.Motors.Simple;             use NXT.Motors.Simple;
with NXT.Motors.Simple.Ctors;       use NXT.Motors.Simple.Ctors;
with NXT.Sensor_Ports;
with NXT.Sound_Sensors;             use NXT.Sound_Sensors;
with NXT.Sound_Sensors.Ctors;       use NXT.Sound_Sensors.Ctors;
with NXT.Touch_Sensors;             use NXT.Touch_Sensors;
with NXT.Ultrasonic_Sensors;        use NXT.Ultrasonic_Sensors;
with NXT.Ultrasonic_Sensors.Ctors;  use NXT.Ultrasonic_Sensors.Ctors;

procedure Compatibility is

   Step : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "step";
   Wrong : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "wrong";
   --  The first step whose expectation failed.

   procedure Check (Expectation : Boolean) is
   begin
      Step := Step + 1;
      if not Expectation and then Wrong = 0 then
         Wrong := Step;
      end if;
   end Check;

   procedure Wait (Milliseconds_Number : Positive) is
   begin
      delay until Clock + Milliseconds (Milliseconds_Number);
   end Wait;

   --  Eight samples of 8 bits at 8,000 Hz
   Beep_File : constant array (1 .. 52) of Unsigned_8 :=
     (16#52#, 16#49#, 16#46#, 16#46#, 44, 0, 0, 0, 16#57#, 16#41#, 16#56#, 16#45#,
      16#66#, 16#6D#, 16#74#, 16#20#, 16, 0, 0, 0, 1, 0, 1, 0,
      16#40#, 16#1F#, 0, 0, 16#40#, 16#1F#, 0, 0, 1, 0, 8, 0,
      16#64#, 16#61#, 16#74#, 16#61#, 8, 0, 0, 0, 0, 255, 0, 255, 0, 255, 0, 255);
   Beep : File with Import, Address => Beep_File'Address;

   procedure Use_Motors is
      Engine : Simple_Motor := Make (Motor_A);
   begin
      Engine.Set_Power (50);
      Engine.Forward;
      Check (Engine.Moving and then Engine.Current_Power = 50 and then Engine.Id = Motor_A);
      Engine.Reverse_Direction;
      Engine.Backward;
      Engine.Stop (Apply_Brake => True);
      Check (not Engine.Moving);
      Control_Motor (Motor_B, NXT.PWM_Value (60), Forward);
      Control_Motor (Motor_C, 0, Coast);
      Wait (200);
      Check (Encoder_Count (Motor_B) > 0);
      Encoder_Count (Motor_B) := 0;
      Check (Encoder_Count (Motor_B) in 0 .. 2);
      NXT.AVR.Set_Power (Motor_B, 0, True);
   end Use_Motors;

   procedure Use_Sensors is
      Bumper : Touch_Sensor (Sensor_1);
      Eye    : Light_Sensor := Make (Sensor_2, Floodlight_On => True);
      Ear    : Sound_Sensor := Make (Sensor_3, DBA_Mode => False);
      Level  : Unsigned_16;
   begin
      Check (not Bumper.Pressed and then not Pressed (Bumper));
      Level := Raw_Input (Sensor_1);
      Check (Level > 1_000);
      Check (Raw_Battery /= 0 and then Millivolts in 7_900 .. 8_100);
      Check (Eye.Light_Value in 0 .. 100 and then Eye.Floodlight_On);
      Check (Eye.Floodlight_Color = Red);
      Eye.Calibrate_Low;
      Eye.Set_High (100);
      Check (Eye.Get_High = 100 and then Eye.Get_Low > 100);
      Check (Eye.Normalized_Light_Value >= 0);
      Eye.Enable_Floodlight (False);
      Ear.Use_DBA_Mode;
      Check (Ear.DBA_Mode and then Ear.Sound_Level >= 0);
      Ear.Use_DB_Mode;
      Check (NXT.AVR.Button = No_Button and then Current_Button = No_Button);
   end Use_Sensors;

   procedure Use_Sonar is
      Sonar   : Ultrasonic_Sensor := Make (Sensor_4);
      Reading : Natural;
      Echoes  : Distances (1 .. 8);
      Actual  : Natural;
      Mode    : Operating_Mode;
      Units   : Units_String;
      Success : Boolean;
   begin
      Sonar.Reset;
      Sonar.Ping;
      Sonar.Get_Distance (Reading);
      Check (Reading = 40);
      Sonar.Get_Distances (Echoes, Actual);
      Check (Actual >= 1 and then Echoes (1) = 40);
      Sonar.Set_Mode (Continuous);
      Sonar.Query_Current_Mode (Mode);
      Check (Mode = Continuous);
      Sonar.Get_Units (Units, Success);
      Check (Success and then Units (1 .. 6) = "10E-2m");
      Sonar.Off;
      Check (not NXT.I2C_Ports.Busy (Sensor_4) and then NXT.I2C_Ports.Enabled (Sensor_4));
   end Use_Sonar;

   procedure Use_Display is
      Block : constant LCD_Line (0 .. 3) := (16#FF#, 16#81#, 16#81#, 16#FF#);
   begin
      Clear_Screen;
      Put ("all");
      Put (' ');
      Put_Noupdate (Integer'(-12));
      Put_Noupdate (Long_Long_Integer'(34));
      New_Line;
      Put_Hex (Unsigned_8'(16#5A#));
      Put_Hex (Unsigned_16'(16#BEEF#));
      Put_Hex (Unsigned_32'(16#12_3456#));
      Newline_Noupdate;
      NXT.Display.Concurrent.Put_Line ("two tasks");
      NXT.Display.Concurrent.Put (7);
      Set_Pos (4, 5);
      Put_Noupdate ("here");
      NXT.Graph.Draw_Glyph (90, 50, Block);
      Wait (20);
      Write (7, 10, Font5x8 ('A'));
      Set_Inverse_Display (False);
      Set_All_Pixels_On (False);
      Set_Pot (16#5A#);
   end Use_Display;

   procedure Use_Sound is
   begin
      Play_Tone (1_000, 50, 60);
      Check (Time_Remaining in 1 .. 60);
      Mute;
      Unmute;
      Wait (80);
      Check (Time_Remaining = 0);
      Play (Beep, 50);
   end Use_Sound;

   procedure Use_Filter is
      package Button_Filters is new NXT.Filtering (Button_Id, No_Button);
      Debounced : Button_Filters.Filter (3);
      Pressed   : Button_Id := No_Button;
   begin
      for Sample in 1 .. 3 loop
         Check (Pressed = No_Button);
         Pressed := Button_Filters.Filtered (Debounced, Left_Button);
      end loop;
      Check (Pressed = Left_Button);
      Check (Button_Filters.Filtered (Debounced, No_Button) = Left_Button);
   end Use_Filter;

   procedure Use_Port is
      use NXT.Sensor_Ports;
   begin
      NXT.Sensor_Ports.Set_Input_Power (Sensor_1, NXT_9V);
      Set_Pin_Mode (Sensor_1, Digital_0, Output);
      Set_Pin_State (Sensor_1, Digital_0, High);
      Check (Current_State (Sensor_1, Digital_0) = High);
      Reset (Sensor_1);
      Reset_All_Ports;
   end Use_Port;

begin
   NXT.AVR.Await_Data_Available;
   Use_Sensors;
   Use_Motors;
   Use_Sonar;
   Use_Display;
   Use_Sound;
   Use_Filter;
   Use_Port;
   loop
      NXT.AVR.Power_Down;
      Wait (100);
   end loop;
end Compatibility;
