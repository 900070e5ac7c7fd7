--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;  use Ada.Real_Time;
with NXT.AVR;
with NXT.Display;    use NXT.Display;
with NXT.Motor_Controls;
with NXT.Touch_Sensors;

package body Tasks is

   use NXT;

   Control_Period : constant Time_Span := Milliseconds (20);
   Display_Period : constant Time_Span := Milliseconds (500);

   --  Counted from the co-processor task: inputs are fresh at each release
   First_Release : constant Time := NXT.AVR.First_Release + Milliseconds (100);

   --  Shared by both tasks; its priority is that of the highest of them
   protected Presses with Priority => System.Priority'First + 2 is
      procedure Add;
      function Count return Natural;
   private
      Total : Natural := 0;
   end Presses;

   protected body Presses is

      procedure Add is
      begin
         Total := Total + 1;
      end Add;

      function Count return Natural is (Total);

   end Presses;

   task body Control_Task is
      Sensor       : NXT.Touch_Sensors.Touch_Sensor (Sensor_1);
      Before       : Boolean := False;
      Now          : Boolean;
      Next_Release : Time := First_Release;
   begin
      loop
         delay until Next_Release;
         Now := NXT.Touch_Sensors.Pressed (Sensor);
         if Now and then not Before then
            Presses.Add;
         end if;
         NXT.Motor_Controls.Drive (Motor_B, (if Now then 50 else 0));
         Before := Now;
         Next_Release := Next_Release + Control_Period;
      end loop;
   end Control_Task;

   task body Display_Task is
      Next_Release : Time := First_Release;
   begin
      loop
         delay until Next_Release;
         Clear_Screen_Noupdate;
         Put_Noupdate ("presses ");
         Put_Noupdate (Presses.Count);
         Screen_Update;
         Next_Release := Next_Release + Display_Period;
      end loop;
   end Display_Task;

end Tasks;
