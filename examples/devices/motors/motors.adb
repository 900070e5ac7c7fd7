--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A motor forward for a second, braked, backward for half a second, and left to coast.

with Ada.Real_Time;       use Ada.Real_Time;
with NXT.AVR;
with NXT.Display;         use NXT.Display;
with NXT.Motor_Controls;  use NXT.Motor_Controls;
with NXT.Motor_Encoders;  use NXT.Motor_Encoders;

procedure Motors is

   use NXT;

   Next : Time;

   procedure Wait (Span : Time_Span) is
   begin
      Next := Next + Span;
      delay until Next;
   end Wait;

   procedure Show (Row : Char_Rows; Text : String) is
   begin
      Put_At_Noupdate (0, Row, Text);
      Set_Pos (9, Row);
      Put (Current.Counts (Motor_B), Width => 5);
   end Show;

begin
   NXT.AVR.Await_Data_Available;
   Next := Clock;
   Drive (Motor_B, 60);
   Wait (Seconds (1));
   Show (0, "forward");
   Brake (Motor_B);
   Wait (Milliseconds (300));
   Show (1, "braked");
   Drive (Motor_B, -60);
   Wait (Milliseconds (500));
   Show (2, "back");
   Coast (Motor_B);
   Wait (Milliseconds (500));
   Show (3, "coasted");
   delay until Time_Last;
end Motors;
