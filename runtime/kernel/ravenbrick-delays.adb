--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with System;

with Ravenbrick.Alarm;
with Ravenbrick.Clock;
with Ravenbrick.Failures;
with Ravenbrick.Processor;

package body Ravenbrick.Delays is

   Latest : constant Units := Units'Last - 1;

   Sentinel : aliased Thread;
   --  Last of the queue: later than any thread

   Spent_In_Delay : constant := 48;
   --  As Spent_In_Ring

   procedure Ring (Unused : System.Address) with Convention => C;

   procedure Initialize is
   begin
      Sentinel.Wake := Units'Last;
      Head := Sentinel'Access;
      Alarm.Initialize;
      Interrupts.Attach
        (Source   => Registers.TC0_Id,
         Priority => System.Interrupt_Priority'First,
         Code     => Ring'Address,
         Object   => System.Null_Address);
      Ring (System.Null_Address);
   end Initialize;

   procedure Insert (Sleeper : not null Thread_Id; Now : Units) is
      Wake     : constant Units := Sleeper.Wake;
      Previous : Thread_Id := Head;
      Follower : Thread_Id;
   begin
      if Wake < Previous.Wake then
         Sleeper.Next := Previous;
         Head := Sleeper;
         Alarm.Set (Wake - Now, Spent => Spent_In_Delay);
      else
         loop
            Follower := Previous.Next;
            exit when Wake < Follower.Wake;
            Previous := Follower;
         end loop;
         Sleeper.Next := Follower;
         Previous.Next := Sleeper;
      end if;
   end Insert;

   procedure Delay_Until (Wake : Units) is
      Self : constant not null Thread_Id := Kernel.Current;
      Now  : Units;
   begin
      if In_Protected_Action (Self.Active) then
         Failures.Stop (Failures.Blocking'Address);
      end if;
      Processor.Mask_In_Thread;
      Self.Wake := Units'Min (Wake, Latest);
      Self.State := Delayed;
      Now := Clock.Now;
      if Wake > Now then
         Insert (Self, Now);
         Block (Self);
      else
         Self.State := Ready;
         Yield (Self);
      end if;
   end Delay_Until;

   --  The alarm has the lowest interrupt priority: it only makes threads ready, which every
   --  handler may delay. Interrupts are unmasked between two threads, so that the masked time
   --  does not grow with the number of threads released together.

   procedure Ring (Unused : System.Address) is
      Now      : Units;
      At_Count : Clock.Count;
      Previous : Processor.Status;
      Sleeper  : Thread_Id;
   begin
      Alarm.Acknowledge;
      Processor.Mask_Interrupts (Previous);
      Clock.Observe (Now, At_Count);
      loop
         Sleeper := Head;
         exit when Sleeper.Wake > Now;
         Head := Sleeper.Next;
         Make_Ready (Sleeper);
         Processor.Restore_Interrupts (Previous);
         Processor.Mask_Interrupts (Previous);
      end loop;
      Alarm.Set (Sleeper.Wake - Now - Clock.Since (At_Count), Spent => Spent_In_Ring);
      Processor.Restore_Interrupts (Previous);
   end Ring;

end Ravenbrick.Delays;
