--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Absolute delays: the queue of delayed threads and the interrupt of the alarm

with Ravenbrick.Threads;

package Ravenbrick.Delays is
   pragma Preelaborate;

   procedure Initialize with Export, Convention => C, External_Name => "ravenbrick_start_alarm";
   --  Attach the alarm's handler and ring for the first time

   procedure Delay_Until (Wake : Threads.Units);
   --  Block the running thread until the clock has reached Wake; when it already has, the
   --  thread only lets its equals run first. Program_Error in a protected action.

end Ravenbrick.Delays;
