--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Drives, then breaks a range: nothing handles the exception.

with Ada.Real_Time;       use Ada.Real_Time;
with NXT.AVR;
with NXT.Motor_Controls;  use NXT.Motor_Controls;

procedure Last_Chance is

   use type NXT.PWM_Value;

   Duty : Duty_Cycle := 60 with Volatile;
begin
   NXT.AVR.Await_Data_Available;
   Drive (NXT.Motor_B, Duty);
   Drive (NXT.Motor_C, -Duty);
   delay until NXT.AVR.First_Release + Milliseconds (400);
   Duty := Duty + 60;  --  the failure
   Drive (NXT.Motor_B, Duty);
end Last_Chance;
