--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Drives, then switches the brick off half a second after the start.

with Ada.Real_Time;       use Ada.Real_Time;
with NXT.AVR;
with NXT.Motor_Controls;

procedure Power_Off is
begin
   NXT.AVR.Await_Data_Available;
   NXT.Motor_Controls.Drive (NXT.Motor_B, 80);
   delay until NXT.AVR.First_Release + Milliseconds (500);
   NXT.AVR.Power_Down;
   delay until Time_Last;
end Power_Off;
