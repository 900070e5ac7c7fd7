--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;  use Ada.Real_Time;
with Ada.Synchronous_Task_Control;  use Ada.Synchronous_Task_Control;
with NXT.AVR;
with NXT.Buttons;
with NXT.Motor_Controls;

package body Commanding is

   use type NXT.Button_Id;

   Presses : Integer := 0 with Volatile, Export, Convention => C, External_Name => "presses";

   Never : Suspension_Object;

   task body Suspended_Task is
   begin
      loop
         Suspend_Until_True (Never);
      end loop;
   end Suspended_Task;

   task body Driving_Task is
      Next   : Time := NXT.AVR.First_Release;
      Before : NXT.Button_Id := NXT.No_Button;
      Now    : NXT.Button_Id;
   begin
      NXT.AVR.Await_Data_Available;
      loop
         NXT.Motor_Controls.Drive (NXT.Motor_B, 60);
         Now := NXT.Buttons.Current_Button;
         if Now = NXT.Power_Button and then Before /= NXT.Power_Button then
            Presses := Presses + 1;
         end if;
         Before := Now;
         Next := Next + NXT.AVR.Period;
         delay until Next;
      end loop;
   end Driving_Task;

end Commanding;
