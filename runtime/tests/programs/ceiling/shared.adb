--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;
with Ada.Synchronous_Task_Control; use Ada.Synchronous_Task_Control;

with Journal; use Journal;

package body Shared is

   Below_May_Run, Level_May_Run, Above_May_Run : Suspension_Object;

   protected body Object is
      procedure Release_All is
      begin
         Note ('(');
         Set_True (Below_May_Run);
         Note ('1');
         Set_True (Level_May_Run);
         Note ('2');
         Set_True (Above_May_Run);
         Note (')');
      end Release_All;
   end Object;

   task body Owner is
      Next : Time := Clock;
   begin
      loop
         Next := Next + Milliseconds (1);
         delay until Next;
         Object.Release_All;
         Note (';');
      end loop;
   end Owner;

   task body Below is
   begin
      loop
         Suspend_Until_True (Below_May_Run);
         Note ('b');
      end loop;
   end Below;

   task body Level is
   begin
      loop
         Suspend_Until_True (Level_May_Run);
         Note ('l');
      end loop;
   end Level;

   task body Above is
   begin
      loop
         Suspend_Until_True (Above_May_Run);
         Note ('a');
      end loop;
   end Above;

end Shared;
