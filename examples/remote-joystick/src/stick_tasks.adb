--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;  use Ada.Real_Time;
with NXT.AVR;
with NXT.Buttons;    use NXT.Buttons;
with NXT.Display;    use NXT.Display;
with Stick;

package body Stick_Tasks is

   use NXT;

   Display_Period : constant Time_Span := Milliseconds (500);

   procedure Draw (Now : Stick.Status) is
   begin
      Clear_Screen_Noupdate;
      Put_Noupdate (case Now.Contact is
                       when Stick.Looking   => "looking",
                       when Stick.Calling   => "calling",
                       when Stick.Connected => "connected");
      Set_Pos (0, 1);
      Put_Noupdate (if Now.Running then "driving" else "standing");
      Set_Pos (0, 2);
      Put_Noupdate ("angle ");
      Put_Noupdate (Now.Angle, Width => 4);
      Screen_Update;
   end Draw;

   task body Display_Task is
      Next_Release : Time := NXT.AVR.First_Release + Milliseconds (100);
   begin
      loop
         delay until Next_Release;
         Draw (Stick.Latest);
         if NXT.AVR.Data_Available and then Current_Button = Power_Button then
            NXT.AVR.Power_Down;
         end if;
         Next_Release := Next_Release + Display_Period;
      end loop;
   end Display_Task;

end Stick_Tasks;
