--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with System;

with Ravenbrick.Alarm;
with Ravenbrick.Clock;
with Ravenbrick.Failures;
with Ravenbrick.Interrupts;
with Ravenbrick.Processor;
with Ravenbrick.Registers;

package body Ravenbrick.Delays is

   use Ravenbrick.Threads;

   Latest : constant Units := Units'Last - 1;

   Sentinel : aliased Thread;
   --  Last of the queue: later than any thread

   Head : Thread_Id with Volatile, Suppress_Initialization;
   --  Delayed threads by wake-up time, equal times by arrival

   procedure Insert (Sleeper : not null Thread_Id) with Inline;
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
      Alarm.Set (Head.Wake);
   end Initialize;

   procedure Insert (Sleeper : not null Thread_Id) is
      Previous : Thread_Id := Head;
      Follower : Thread_Id;
   begin
      if Sleeper.Wake < Previous.Wake then
         Sleeper.Next := Previous;
         Head := Sleeper;
         Alarm.Set (Sleeper.Wake);
      else
         loop
            Follower := Previous.Next;
            exit when Sleeper.Wake < Follower.Wake;
            Previous := Follower;
         end loop;
         Sleeper.Next := Follower;
         Previous.Next := Sleeper;
      end if;
   end Insert;

   procedure Delay_Until (Wake : Units) is
      Self : constant not null Thread_Id := Kernel.Current;
   begin
      if In_Protected_Action (Self.Active) then
         Failures.Stop (Failures.Blocking'Address);
      end if;
      Processor.Mask_In_Thread;
      Self.Wake := Units'Min (Wake, Latest);
      Self.State := Delayed;
      if Wake > Clock.Now then
         Insert (Self);
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
      Now      : constant Units := Clock.Now;
      Previous : Processor.Status;
      Sleeper  : Thread_Id;
   begin
      Alarm.Acknowledge;
      loop
         Processor.Mask_Interrupts (Previous);
         Sleeper := Head;
         exit when Sleeper.Wake > Now;
         Head := Sleeper.Next;
         Make_Ready (Sleeper);
         Processor.Restore_Interrupts (Previous);
      end loop;
      Clock.Observe;
      Alarm.Set (Sleeper.Wake);
      Processor.Restore_Interrupts (Previous);
   end Ring;

end Ravenbrick.Delays;
