--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Coding of the co-processor's messages: results in symbols for an observer.

with Ada.Real_Time;
with NXT.AVR_IO;  use NXT.AVR_IO;

procedure Messages is

   use NXT;

   Idle : Output_Frame := Encode (All_Stopped) with
     Volatile, Export, Convention => C, External_Name => "idle_frame";

   Busy : Output_Frame :=
     Encode
       ((Power         => Stay_On,
         Duties        => (Motor_A => 100, Motor_B => -1, Motor_C => -100),
         Brakes        => (Motor_A => True, Motor_B => False, Motor_C => True),
         Sensor_Supply => (Sensor_2 => RCX_9V, Sensor_4 => NXT_9V, others => Standard_Power))) with
     Volatile, Export, Convention => C, External_Name => "busy_frame";

   Off : Output_Frame := Encode ((Power => Switch_Off, others => <>)) with
     Volatile, Export, Convention => C, External_Name => "off_frame";

   Hello : Greeting_Frame := Greeting with
     Volatile, Export, Convention => C, External_Name => "greeting";

   pragma Unreferenced (Idle, Busy, Off, Hello);

   type Frames is array (1 .. 4) of Input_Frame;
   type Numbers is array (1 .. 4) of Integer;

   --  Touched, right button, 528 of a rechargeable pack; sum wrong by one; not sampling yet; all
   --  buttons at once with the readings' upper bounds
   Samples : constant Frames :=
     ((16#B4#, 0, 16#FF#, 3, 0, 2, 1, 0, 16#60#, 1, 16#10#, 16#A6#, 16#2F#),
      (16#B4#, 0, 16#FF#, 3, 0, 2, 1, 0, 16#60#, 1, 16#10#, 16#A6#, 16#30#),
      (1 .. 12 => 0, 13 => 16#FF#),
      (16#FF#, 3, 16#FF#, 3, 16#FF#, 3, 16#FF#, 3, 16#FE#, 16#0B#, 16#FF#, 16#27#, 16#C8#));

   Verdicts : Numbers := (others => -1) with
     Volatile, Export, Convention => C, External_Name => "verdicts";
   Sensor  : Numbers := (others => -1) with
     Volatile, Export, Convention => C, External_Name => "sensor_1";
   Button  : Numbers := (others => -1) with
     Volatile, Export, Convention => C, External_Name => "button";
   Battery : Numbers := (others => -1) with
     Volatile, Export, Convention => C, External_Name => "battery_count";
   Pack    : Numbers := (others => -1) with
     Volatile, Export, Convention => C, External_Name => "pack";

   Values : NXT.AVR_IO.Inputs;
   Result : Verdict;
begin
   for Sample in Samples'Range loop
      Decode (Samples (Sample), Values, Result);
      Verdicts (Sample) := Verdict'Pos (Result);
      Sensor (Sample) := Integer (Values.Sensors (Sensor_1));
      Button (Sample) := Button_Id'Pos (Values.Pressed);
      Battery (Sample) := Integer (Values.Battery_Count);
      Pack (Sample) := Boolean'Pos (Values.Rechargeable);
   end loop;
   delay until Ada.Real_Time.Time_Last;
end Messages;
