--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;  use Ada.Real_Time;
with Controller_Design;
with Following;
with NXT.AVR;
with NXT.Display;    use NXT.Display;

package body Tasks is

   First_Release  : constant Time := NXT.AVR.First_Release + Milliseconds (100);
   Control_Period : constant Time_Span := Milliseconds (Controller_Design.Sample_Time_Ms);
   Display_Period : constant Time_Span := Milliseconds (500);

   task body Control_Task is
      Next_Release : Time := First_Release;
   begin
      Following.Start;
      loop
         delay until Next_Release;
         Following.Control;
         Next_Release := Next_Release + Control_Period;
      end loop;
   end Control_Task;

   procedure Put_Row (Row : Char_Rows; Name : String; Value : Integer) is
   begin
      Set_Pos (0, Row);
      Put_Noupdate (Name);
      Put_Noupdate (Value, Width => 6);
   end Put_Row;

   subtype Title is String (1 .. 9);

   function Title_Of (Running : Boolean) return Title is
     (if Running then "following" else "stopped  ");

   task body Display_Task is
      Next_Release : Time := First_Release;
      Now          : Following.Status;
   begin
      loop
         delay until Next_Release;
         Now := Following.Latest;
         Clear_Screen_Noupdate;
         Put_Noupdate (Title_Of (Now.Running));
         Put_Row (2, "light  ", Integer (Now.Brightness * 100.0));
         Put_Row (3, "mV     ", Integer (Now.Steering * 1000.0));
         Screen_Update;
         Next_Release := Next_Release + Display_Period;
      end loop;
   end Display_Task;

end Tasks;
