--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Each motor in each way, a change every 100 ms from 200 ms on.

with Ada.Real_Time;       use Ada.Real_Time;
with NXT.AVR;
with NXT.Motor_Controls;  use NXT.Motor_Controls;

procedure Motors is

   use NXT;

   Next : Time := NXT.AVR.First_Release;

   procedure Wait (Milliseconds_More : Positive) is
   begin
      Next := Next + Milliseconds (Milliseconds_More);
      delay until Next;
   end Wait;

begin
   Wait (200);
   Drive (Motor_A, 50);
   Control_Motor (Motor_B, 75, Backward);
   Drive (Motor_C, 30, Off_Phase => Fast);
   Wait (100);
   Brake (Motor_A);
   Coast (Motor_B);
   NXT.AVR.Set_Power (Motor_C, -100, Brake => False);
   Wait (100);
   Brake_All;
   delay until Time_Last;
end Motors;
