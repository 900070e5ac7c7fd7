--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Saves a growing number again and again, guarded against a low supply unless the touch sensor is
--  pressed when it starts.

with Ada.Real_Time;      use Ada.Real_Time;
with NXT.AVR;
with NXT.Parameters;     use NXT.Parameters;
with NXT.Power;          use NXT.Power;
with NXT.Touch_Sensors;  use NXT.Touch_Sensors;

procedure Brown_Out is

   type Pair is record
      Number, Inverse : Integer;
   end record;

   package Kept is new Store (Pair, Id => 3, Format => 1);

   Cause : Integer := -1 with Volatile, Export, Convention => C, External_Name => "cause";
   Loaded : Integer := -1 with Volatile, Export, Convention => C, External_Name => "loaded";
   Mixed : Integer := -1 with Volatile, Export, Convention => C, External_Name => "mixed";
   Saved_Number : Integer := -1 with
     Volatile, Export, Convention => C, External_Name => "saved_number";
   Failures : Integer := -1 with Volatile, Export, Convention => C, External_Name => "failures";

   Switch  : Touch_Sensor (NXT.Sensor_1);
   Current : Pair := (0, -1);
   Found   : Boolean;
   Result  : Save_Result;
begin
   Cause := Reset_Cause'Pos (Last_Reset);
   NXT.AVR.Await_Data_Available;
   delay until Clock + Milliseconds (20);
   if not Switch.Pressed then
      Reset_At_Brown_Out;
   end if;
   Kept.Load (Current, Found);
   Mixed := Boolean'Pos (Found and then Current.Inverse /= -Current.Number - 1);
   Loaded := Current.Number;
   Saved_Number := Current.Number;
   Failures := 0;
   loop
      Current.Number := Current.Number + 1;
      Current.Inverse := -Current.Number - 1;
      Kept.Save (Current, Result);
      if Result = Saved then
         Saved_Number := Current.Number;
      else
         Failures := Failures + 1;
      end if;
      delay until Clock + Milliseconds (1);
   end loop;
end Brown_Out;
