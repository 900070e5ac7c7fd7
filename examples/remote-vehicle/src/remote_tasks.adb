--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;  use Ada.Real_Time;
with Air;
with Controller_Design;
with NXT.AVR;
with NXT.Display;    use NXT.Display;
with Remote_Driving;

package body Remote_Tasks is

   First_Release  : constant Time := NXT.AVR.First_Release + Milliseconds (100);
   Control_Period : constant Time_Span := Milliseconds (Controller_Design.Sample_Time_Ms);
   Display_Period : constant Time_Span := Milliseconds (500);

   task body Control_Task is
      Next_Release : Time := First_Release;
   begin
      Remote_Driving.Start;
      loop
         delay until Next_Release;
         Remote_Driving.Control;
         Next_Release := Next_Release + Control_Period;
      end loop;
   end Control_Task;

   task body Display_Task is
      Next_Release : Time := First_Release;
      Now          : Remote_Driving.Status;
   begin
      loop
         delay until Next_Release;
         Now := Remote_Driving.Latest;
         Clear_Screen_Noupdate;
         if Now.Driving then
            Put_Noupdate ("driving");
         else
            Put_Noupdate ("standing");
         end if;
         Set_Pos (0, 1);
         Put_Noupdate (case Now.Contact is
                          when Air.Nobody => "no joystick",
                          when Air.Silent => "joystick silent",
                          when Air.Heard  => "joystick heard");
         Set_Pos (0, 2);
         Put_Noupdate ("angle ");
         Put_Noupdate (Now.Angle, Width => 4);
         Screen_Update;
         Next_Release := Next_Release + Display_Period;
      end loop;
   end Display_Task;

end Remote_Tasks;
