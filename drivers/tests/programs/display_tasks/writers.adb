--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;  use Ada.Real_Time;
with NXT.Display;    use NXT.Display;

package body Writers is

   task body Upper is
      Next : Time := Clock;
   begin
      loop
         Put_At ((if Rounds_Of_Upper mod 2 = 0 then 0 else 4), 1, "upper row");
         Rounds_Of_Upper := Rounds_Of_Upper + 1;
         Next := Next + Microseconds (1_300);
         delay until Next;
      end loop;
   end Upper;

   task body Lower is
      Next : Time := Clock;
   begin
      for Round in 1 .. 100 loop
         Put_At_Noupdate (2, 6, "lower row");
         Next := Next + Microseconds (700);
         delay until Next;
      end loop;
      delay until Time_Last;
   end Lower;

   procedure Keep_Updating is
      Before : Time;
      Span   : Integer;
   begin
      Set_Pos (0, 3);
      Put ("main");
      loop
         Before := Clock;
         Screen_Update;
         Span := (Clock - Before) / Microseconds (1);
         Longest_Update_Us := Integer'Max (Longest_Update_Us, Span);
      end loop;
   end Keep_Updating;

end Writers;
