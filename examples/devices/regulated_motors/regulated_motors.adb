--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A motor with a set speed, then with a set angle.

with Ada.Real_Time;         use Ada.Real_Time;
with NXT.AVR;
with NXT.Display;           use NXT.Display;
with NXT.Regulated_Motors;  use NXT.Regulated_Motors;

procedure Regulated_Motors is

   use NXT;

   Reached : Boolean;

begin
   NXT.AVR.Await_Data_Available;
   Run (Motor_B, Speed => 360);
   delay until Clock + Seconds (1);
   Put_At_Noupdate (0, 0, "speed");
   Set_Pos (9, 0);
   Put (Integer (Speed (Motor_B)), Width => 5);
   Turn_To (Motor_B, Angle => 90, Speed => 500);
   Await_Arrival (Motor_B, Limit => Seconds (3), Success => Reached);
   Put_At_Noupdate (0, 1, (if Reached then "at" else "not at"));
   Set_Pos (9, 1);
   Put (Integer (Angle (Motor_B)), Width => 5);
   Stop (Motor_B, Final => Brake);
   delay until Time_Last;
end Regulated_Motors;
