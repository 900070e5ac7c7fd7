--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Voltage and kind of the battery; the orange button switches the brick off.

with Ada.Real_Time;  use Ada.Real_Time;
with NXT.AVR;
with NXT.Battery;    use NXT.Battery;
with NXT.Buttons;    use NXT.Buttons;
with NXT.Display;    use NXT.Display;
with NXT.Power;

procedure Battery_Level is

   use type NXT.Button_Id;

   Next : Time;
begin
   NXT.AVR.Await_Data_Available;
   Next := Clock;
   loop
      Put_At_Noupdate (0, 0, "battery       mV");
      Set_Pos (8, 0);
      Put_Noupdate (Integer (Voltage), Width => 5);
      Put_At (0, 1, (if Rechargeable then "rechargeable" else "six cells   "));
      if Current_Button = NXT.Power_Button then
         NXT.Power.Switch_Off;
      end if;
      Next := Next + Milliseconds (200);
      delay until Next;
   end loop;
end Battery_Level;
