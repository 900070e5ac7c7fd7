--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Processor status and the exchange of register contexts.
--  Threads and the idle loop run in System mode, interrupt handlers in Supervisor mode.

with Interfaces;
with Ravenbrick.Threads;

package Ravenbrick.Processor is
   pragma Preelaborate;

   type Status is new Interfaces.Unsigned_32;
   --  Image of the current program status register

   procedure Mask_Interrupts (Previous : out Status) with Inline_Always;
   --  Set the I flag; Previous is the status before

   procedure Restore_Interrupts (Previous : Status) with Inline_Always;
   --  Put back the I flag that Mask_Interrupts found

   function In_Thread (Previous : Status) return Boolean is ((Previous and 16#1F#) = 16#1F#)
     with Inline_Always;
   --  Whether the status belongs to a thread, not to an interrupt handler

   procedure Mask_In_Thread with Inline_Always;
   procedure Unmask_In_Thread with Inline_Always;
   --  The same for callers that are known to be threads

   procedure Switch (From, To : not null Threads.Thread_Id) with Inline_Always;
   --  Save the caller's context in From, make To the running thread and load its context.
   --  Interrupts are masked on call and unmasked on return.
   --  Nothing of the caller's registers survives, the parameters neither.
   --  A context is the address to go on at, on top of the thread's stack; the registers are on
   --  the stack below it, saved and restored by the subprogram that calls Switch.

   procedure Switch_To_Idle (From : not null Threads.Thread_Id) with Inline_Always;
   --  Save the caller's context in From and stop the processor until an interrupt.
   --  Interrupts are masked on call and unmasked on return.

   procedure Thread_Start
     with Import, Convention => C, External_Name => "ravenbrick_thread_start";
   --  Where every thread starts: calls its body with its argument

end Ravenbrick.Processor;
