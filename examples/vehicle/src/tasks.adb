--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;  use Ada.Real_Time;
with Controller_Design;
with Driving;
with NXT.AVR;
with Panel;

package body Tasks is

   --  Counted from the co-processor task, two of its periods of 2 ms are one of control: inputs
   --  are asked for at the beginning of each control period, outputs are sent in its middle.
   First_Release : constant Time := NXT.AVR.First_Release + Milliseconds (100);

   Control_Period : constant Time_Span := Milliseconds (Controller_Design.Sample_Time_Ms);
   Display_Period : constant Time_Span := Milliseconds (500);

   task body Control_Task is
      Vehicle      : Driving.Vehicle;
      Next_Release : Time := First_Release;
   begin
      Driving.Start (Vehicle);
      loop
         delay until Next_Release;
         Driving.Control (Vehicle);
         Panel.Publish (Driving.Current_Status (Vehicle));
         Next_Release := Next_Release + Control_Period;
      end loop;
   end Control_Task;

   task body Display_Task is
      Next_Release : Time := First_Release;
   begin
      loop
         delay until Next_Release;
         Panel.Draw;
         Next_Release := Next_Release + Display_Period;
      end loop;
   end Display_Task;

end Tasks;
