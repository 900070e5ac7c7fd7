--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Absolute delays: the queue of delayed threads and the interrupt of the alarm

with Ravenbrick.Interrupts;
with Ravenbrick.Registers;
with Ravenbrick.Threads;

package Ravenbrick.Delays is
   pragma Preelaborate;

   procedure Initialize
     with Export, Convention => C, External_Name => "ravenbrick_start_alarm",
          Post => Interrupts.Is_Attached (Registers.TC0_Id);
   --  Attach the alarm's handler and ring for the first time

   procedure Delay_Until (Wake : Threads.Units)
     with Global => (In_Out => Threads.Kernel),
          Pre    => not Threads.Interrupts_Masked,
          Post   => not Threads.In_Protected_Action (Threads.Kernel.Current.Active)
                    and then not Threads.Interrupts_Masked;
   --  Block the running thread until the clock has reached Wake; when it already has, the
   --  thread only lets its equals run first. Program_Error in a protected action.

private

   use Ravenbrick.Threads;

   Head : Thread_Id with Volatile, Suppress_Initialization;
   --  Delayed threads by wake-up time, equal times by arrival

   Spent_In_Ring : constant := 28;
   --  Times 2 cycles pass between the reading of the clock and the start of the alarm, in ARM
   --  state from RAM; from flash it is more

   procedure Insert (Sleeper : not null Thread_Id; Now : Units)
     with Inline,
          Pre  => Interrupts_Masked and then Sleeper.Wake < Units'Last,
          Post => Head.Wake <= Sleeper.Wake;
   --  Into the queue by Sleeper.Wake, and set the alarm when it is the first

end Ravenbrick.Delays;
