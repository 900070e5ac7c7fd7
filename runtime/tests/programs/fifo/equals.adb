--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;
with Ada.Synchronous_Task_Control; use Ada.Synchronous_Task_Control;

with Journal; use Journal;

package body Equals is

   A_May_Run, B_May_Run, C_May_Run : Suspension_Object;

   procedure Three_Turns (Mark : Character) is
   begin
      for Turn in 1 .. 3 loop
         Note (Mark);
         delay until Time_First;
      end loop;
   end Three_Turns;

   task body A is
   begin
      Note ('1');
      loop
         Suspend_Until_True (A_May_Run);
         Three_Turns ('a');
      end loop;
   end A;

   task body B is
   begin
      Note ('2');
      loop
         Suspend_Until_True (B_May_Run);
         Three_Turns ('b');
      end loop;
   end B;

   task body C is
   begin
      Note ('3');
      loop
         Suspend_Until_True (C_May_Run);
         Set_True (A_May_Run);
         Three_Turns ('c');
      end loop;
   end C;

   task body Releaser is
      Next : Time := Clock;
   begin
      loop
         Next := Next + Milliseconds (10);
         delay until Next;
         Note ('.');
         Set_True (C_May_Run);
         Set_True (B_May_Run);
      end loop;
   end Releaser;

end Equals;
