--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Motors with set speeds and angles, one command after the other.

with Ada.Real_Time;         use Ada.Real_Time;
with NXT.AVR;
with NXT.Motor_Encoders;
with NXT.Regulated_Motors;  use NXT.Regulated_Motors;

procedure Regulated_Motors is

   use NXT;

   Angle_B : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "angle_b";
   Speed_B : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "speed_b";
   Angle_C : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "angle_c";
   Arrivals : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "arrivals";
   Kind_B : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "kind_b";

   Next    : Time := NXT.AVR.First_Release + Milliseconds (400);
   Success : Boolean;

   procedure Wait (Span : Time_Span) is
   begin
      Next := Next + Span;
      while Clock < Next loop
         Angle_B := Integer (Angle (Motor_B));
         Speed_B := Integer (Speed (Motor_B));
         Angle_C := Integer (Angle (Motor_C));
         Kind_B := Regulation'Pos (Regulation_Of (Motor_B));
         delay until Clock + Milliseconds (2);
      end loop;
   end Wait;

begin
   NXT.AVR.Await_Data_Available;
   Wait (Milliseconds (0));
   Run (Motor_B, 300);
   Turn_To (Motor_C, 720, Speed => 400);
   Wait (Milliseconds (1_000));
   NXT.Motor_Encoders.Encoder_Count (Motor_A) := Integer'Last;
   Wait (Milliseconds (600));
   NXT.Motor_Encoders.Encoder_Count (Motor_A) := Integer'First;
   Turn_To (Motor_A, Degrees'Last);
   Wait (Milliseconds (100));
   Stop (Motor_A);
   Wait (Milliseconds (900));
   Await_Arrival (Motor_C, Limit => Seconds (1), Success => Success);
   Arrivals := Boolean'Pos (Success);
   Run (Motor_B, -200);
   Turn_By (Motor_C, -90);
   Wait (Milliseconds (1_500));
   Arrivals := Arrivals + Boolean'Pos (Arrived (Motor_C));
   Stop (Motor_B, Final => NXT.Regulated_Motors.Float);
   Wait (Milliseconds (500));
   Run (Motor_B, 100);
   Turn_To (Motor_C, Angle (Motor_C) + Tolerance);
   Await_Arrival (Motor_C, Limit => Milliseconds (30), Success => Success);
   Arrivals := Arrivals + Boolean'Pos (Success);
   Wait (Seconds (10));
end Regulated_Motors;
