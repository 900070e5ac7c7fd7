--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts.Names; use Ada.Interrupts.Names;
with Ada.Real_Time; use Ada.Real_Time;
with Ada.Synchronous_Task_Control; use Ada.Synchronous_Task_Control;
with System;

with Series;
with Shared;
with Timers; use Timers;

package body Path_Tasks is

   Released : Suspension_Object;
   Served   : Suspension_Object;

   protected Source with Interrupt_Priority => System.Interrupt_Priority'First + 4 is
      procedure Handle with Attach_Handler => TC1;
   end Source;

   protected body Source is
      procedure Handle is
      begin
         Acknowledge (Channel_1);
         Set_True (Served);
      end Handle;
   end Source;

   task body Low is
   begin
      delay until Time_Of (0, Milliseconds (2));
      for Round in 1 .. 3 loop
         Shared.Counter.Add;
         Set_True (Released);
      end loop;
      Start_Once (Channel_1, 1_000);
      Series.Spend (100);
      Finished := True;
   end Low;

   task body High is
   begin
      loop
         Suspend_Until_True (Released);
      end loop;
   end High;

   task body Server is
   begin
      loop
         Suspend_Until_True (Served);
      end loop;
   end Server;

end Path_Tasks;
