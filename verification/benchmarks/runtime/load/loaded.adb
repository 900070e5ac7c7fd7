--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts.Names; use Ada.Interrupts.Names;
with Ada.Real_Time; use Ada.Real_Time;
with Ada.Synchronous_Task_Control; use Ada.Synchronous_Task_Control;

with Interfaces; use Interfaces;

with Timers; use Timers;

package body Loaded is

   Released : Suspension_Object;

   protected Gate with Priority => 20 is
      procedure Open;
      entry Pass;
   private
      Is_Open : Boolean := False;
   end Gate;

   protected Low_Level with Interrupt_Priority => System.Interrupt_Priority'First + 1 is
      procedure Handle with Attach_Handler => TC2;
      procedure Touch;
   private
      Count : Unsigned_32 := 0;
   end Low_Level;

   protected Source with Interrupt_Priority => System.Interrupt_Priority'Last is
      procedure Handle with Attach_Handler => TC1;
   private
      Phase : Unsigned_32 := 1;
   end Source;

   protected body Gate is

      procedure Open is
      begin
         Is_Open := True;
      end Open;

      entry Pass when Is_Open is
      begin
         Is_Open := False;
      end Pass;

   end Gate;

   protected body Low_Level is

      procedure Handle is
      begin
         Acknowledge (Channel_2);
         Set_True (Released);
      end Handle;

      procedure Touch is
      begin
         Count := Count + 1;
      end Touch;

   end Low_Level;

   --  The period changes after each request by a number without regular relation to the tasks'

   protected body Source is
      procedure Handle is
         Passed : constant Cycles := 2 * Cycles (Channel_1.Value);
      begin
         Acknowledge (Channel_1);
         Phase := Phase * 69_069 + 1;
         Channel_1.Compare := 1_000 + Timers.Word (Shift_Right (Phase, 16) mod 2_000);
         if Results.Count < Samples then
            Note (Results, Passed);
         else
            Finished := True;
         end if;
      end Handle;
   end Source;

   task body Driver is
   begin
      delay until Time_Of (0, Milliseconds (2));
      Start_Cyclic (Channel_1, 3_000);
      Start_Cyclic (Channel_2, 7_919);
      loop
         Set_True (Released);
         Gate.Open;
         Low_Level.Touch;
         Spend (Random (8));
      end loop;
   end Driver;

   task body Suspended is
   begin
      loop
         Suspend_Until_True (Released);
      end loop;
   end Suspended;

   task body Waiting is
   begin
      loop
         Gate.Pass;
      end loop;
   end Waiting;

   task body Sleeper is
      Next : Time := Time_Of (0, Milliseconds (5));
   begin
      loop
         delay until Next;
         Next := Next + Microseconds (750);
      end loop;
   end Sleeper;

end Loaded;
