--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Which button is held, 20 times a second.

with Ada.Real_Time;  use Ada.Real_Time;
with NXT.Buttons;    use NXT.Buttons;
with NXT.Display;    use NXT.Display;

procedure Buttons is

   use NXT;

   Next : Time := Clock;

   function Name_Of (Button : Button_Id) return String is
     (case Button is
         when No_Button     => "none  ",
         when Power_Button  => "orange",
         when Left_Button   => "left  ",
         when Middle_Button => "grey  ",
         when Right_Button  => "right ");

begin
   Put_At (0, 0, "Button:");
   loop
      Put_At (8, 0, Name_Of (Current_Button));
      Next := Next + Milliseconds (50);
      delay until Next;
   end loop;
end Buttons;
