--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;  use Ada.Real_Time;
with Balance;
with Controller_Design;
with NXT.AVR;
with NXT.Display;    use NXT.Display;

package body Tasks is

   First_Release  : constant Time := NXT.AVR.First_Release + Milliseconds (100);
   Control_Period : constant Time_Span := Milliseconds (Controller_Design.Sample_Time_Ms);
   Display_Period : constant Time_Span := Milliseconds (500);

   task body Balance_Task is
      Next_Release : Time := First_Release;
   begin
      loop
         delay until Next_Release;
         Balance.Control;
         Next_Release := Next_Release + Control_Period;
      end loop;
   end Balance_Task;

   procedure Put_Row (Row : Char_Rows; Name : String; Value : Integer) is
   begin
      Set_Pos (0, Row);
      Put_Noupdate (Name);
      Put_Noupdate (Value, Width => 6);
   end Put_Row;

   task body Display_Task is
      Next_Release : Time := First_Release;
      Now          : Balance.Status;
   begin
      loop
         delay until Next_Release;
         Now := Balance.Latest;
         Clear_Screen_Noupdate;
         Put_Noupdate (case Now.Mode is
                          when Balance.Calibrating => "hold still",
                          when Balance.Balancing   => "balancing ",
                          when Balance.Fallen      => "fallen    ");
         Put_Row (2, "mrad   ", Integer (Now.Pitch * 1000.0));
         Put_Row (3, "out mV ", Integer (Now.Motor_Voltage * 1000.0));
         Put_Row (4, "rest   ", Integer (Now.Rest));
         Screen_Update;
         Next_Release := Next_Release + Display_Period;
      end loop;
   end Display_Task;

end Tasks;
