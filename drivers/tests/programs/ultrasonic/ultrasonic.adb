--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The ultrasonic sensor at port 4: who it is, then its modes and its calibration, then distances
--  for good.

with Ada.Real_Time;                 use Ada.Real_Time;
with NXT.AVR;
with NXT.Ultrasonic_Sensors.Ctors;  use NXT.Ultrasonic_Sensors, NXT.Ultrasonic_Sensors.Ctors;

procedure Ultrasonic is

   use NXT;

   type Numbers is array (Positive range <>) of Integer;

   Version : String (1 .. 8) := (others => '?') with
     Volatile, Export, Convention => C, External_Name => "version";
   Product : String (1 .. 8) := (others => '?') with
     Volatile, Export, Convention => C, External_Name => "product";
   Kind    : String (1 .. 8) := (others => '?') with
     Volatile, Export, Convention => C, External_Name => "kind";
   Units   : String (1 .. 8) := (others => '?') with
     Volatile, Export, Convention => C, External_Name => "units";
   Modes   : Numbers (1 .. 4) := (others => -1) with
     Volatile, Export, Convention => C, External_Name => "modes";
   Scale   : Numbers (1 .. 3) := (others => -1) with
     Volatile, Export, Convention => C, External_Name => "scale";
   Reading : Integer := -1 with Volatile, Export, Convention => C, External_Name => "reading";
   Status  : Integer := -1 with Volatile, Export, Convention => C, External_Name => "status";
   Rounds  : Integer := 0 with Volatile, Export, Convention => C, External_Name => "rounds";
   Silent  : Integer := 0 with Volatile, Export, Convention => C, External_Name => "silent";
   --  1: without an answer there were no distances either

   Sonar    : Ultrasonic_Sensor := Make (Sensor_4);
   Text     : Units_String;
   Done     : Boolean;
   Mode     : Operating_Mode;
   Distance : Centimetres;
   Result   : Measurement_Status;
   Factory  : Data;
   Echoes   : Distances (1 .. 3);
   Actual   : Natural;
begin
   NXT.AVR.Await_Data_Available;
   Sonar.Get_Version (Text, Done);
   Version := Text;
   Sonar.Get_Product_Id (Text, Done);
   Product := Text;
   Sonar.Get_Sensor_Type (Text, Done);
   Kind := Text;
   Sonar.Get_Units (Text, Done);
   Units := Text;
   for Wanted in Commanded_Operating_Mode range Off .. Capture loop
      Sonar.Set_Mode (Wanted);
      Sonar.Query_Current_Mode (Mode);
      Modes (1 + Operating_Mode'Pos (Wanted)) := Operating_Mode'Pos (Mode);
   end loop;
   Sonar.Set_Calibration_Data ((0, 1, 14), Done);
   Sonar.Get_Calibration_Data (Factory, Done);
   for Place in Factory'Range loop
      Scale (Place) := Integer (Factory (Place));
   end loop;
   Sonar.Set_Mode (Continuous);
   loop
      Sonar.Measure (Distance, Result);
      Reading := Integer (Distance);
      Status := Measurement_Status'Pos (Result);
      if Result = No_Answer then
         Sonar.Get_Distances (Echoes, Actual);
         Silent := Boolean'Pos (Actual = 0 and then Echoes = (1 .. 3 => Out_Of_Range));
      end if;
      Rounds := Rounds + 1;
   end loop;
end Ultrasonic;
