--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Loads two values that the runs before have left, then saves the one again and again and the
--  other now and then.

with Ada.Real_Time;   use Ada.Real_Time;
with NXT.Parameters;  use NXT.Parameters;

procedure Parameters is

   type Calibration is record
      Number  : Integer;
      Inverse : Integer;
      Padding : String (1 .. 40);
   end record;

   package Often  is new Store (Calibration, Id => 1, Format => 1);
   package Seldom is new Store (Integer, Id => 2, Format => 1);

   Seldom_Every : constant := 10;

   Loaded : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "loaded";
   Often_Found : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "often_found";
   Often_Number : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "often_number";
   Seldom_Found : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "seldom_found";
   Seldom_Number : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "seldom_number";
   Mixed : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "mixed";
   --  Whether parts of a value do not belong together.
   Saved_Number : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "saved_number";
   Failures : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "failures";

   Current : Calibration := (Number => 0, Inverse => -1, Padding => (others => ' '));
   Other   : Integer := 0;
   Found   : Boolean;

   procedure Note (Result : Save_Result) is
   begin
      if Result = Memory_Failed then
         Failures := Failures + 1;
      end if;
   end Note;

   Result : Save_Result;
begin
   Often.Load (Current, Found);
   Often_Found := Boolean'Pos (Found);
   Often_Number := Current.Number;
   Mixed := Boolean'Pos (Current.Inverse /= -Current.Number - 1);
   Seldom.Load (Other, Found);
   Seldom_Found := Boolean'Pos (Found);
   Seldom_Number := Other;
   Loaded := 1;
   delay until Clock + Milliseconds (2);
   loop
      Current.Number := Current.Number + 1;
      Current.Inverse := -Current.Number - 1;
      if Current.Number mod Seldom_Every = 1 then
         Other := Current.Number;
         Seldom.Save (Other, Result);
         Note (Result);
      end if;
      Often.Save (Current, Result);
      Note (Result);
      Saved_Number := Current.Number;
   end loop;
end Parameters;
