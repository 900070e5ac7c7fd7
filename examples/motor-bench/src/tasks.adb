--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;  use Ada.Real_Time;
with Bench;
with Controller_Design;
with NXT.AVR;
with NXT.Display;    use NXT.Display;

package body Tasks is

   First_Release  : constant Time := NXT.AVR.First_Release + Milliseconds (100);
   Control_Period : constant Time_Span := Milliseconds (Controller_Design.Sample_Time_Ms);
   Display_Period : constant Time_Span := Milliseconds (500);

   task body Control_Task is
      Next_Release : Time := First_Release;
   begin
      Bench.Start;
      loop
         delay until Next_Release;
         Bench.Control;
         Next_Release := Next_Release + Control_Period;
      end loop;
   end Control_Task;

   procedure Put_Row (Row : Char_Rows; Name : String; Value : Integer) is
   begin
      Set_Pos (0, Row);
      Put_Noupdate (Name);
      Put_Noupdate (Value, Width => 6);
   end Put_Row;

   task body Display_Task is
      Next_Release : Time := First_Release;
      Now          : Bench.Status;
   begin
      loop
         delay until Next_Release;
         Now := Bench.Latest;
         Clear_Screen_Noupdate;
         Put_Noupdate (case Now.Mode is
                          when Bench.Stopped  => "stopped ",
                          when Bench.Speed    => "speed   ",
                          when Bench.Position => "position");
         Put_Row (2, "set mV ", Integer (Now.Setpoint * 1000.0));
         Put_Row (3, "spd mV ", Integer (Now.Speed * 1000.0));
         Put_Row (4, "out mV ", Integer (Now.Control * 1000.0));
         Put_Row (5, "deg    ", Now.Angle);
         Screen_Update;
         Next_Release := Next_Release + Display_Period;
      end loop;
   end Display_Task;

end Tasks;
