--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Ends a program whose tasks no longer meet their deadlines, before a robot drives on without a
--  controller. The linker's command line gives the deadlines by priority, as robot.toml has them
--  (see deadlines.S); a program that is linked without them is not supervised.

with Interfaces;

with Ravenbrick.Threads;

package Ravenbrick.Supervision is
   pragma Preelaborate;

   procedure Check (Elapsed_Ms : Positive)
     with Pre => not Threads.In_Protected_Action (Threads.Kernel.Current.Active);
   --  To be called by the program's most urgent task in each of its periods, Elapsed_Ms long. Keeps
   --  the watchdog from expiring, or fails in the name of a task that
   --  - was late for 100 ms without a break, or for more than an eleventh of the time;
   --  - has not come to its first delay 0.5 s after the start, and for another 100 ms;
   --  - has ended although it has a deadline;
   --  - has overwritten the lowest word of its stack.
   --  It also fails when the main procedure has ended and only the caller is left, and in the first
   --  call after a reset by the watchdog, since the motors still do what they were told before.
   --  A cyclic task is late when its deadline after the time of its latest delay has passed and it
   --  is ready, a sporadic one when it has been ready for longer than its deadline at each check.
   --  Takes time in proportion to the number of tasks.

   Supervised : Interfaces.Unsigned_32
     with Import, Volatile, Convention => C, External_Name => "ravenbrick_supervision";

   function Enabled return Boolean is (Interfaces."/=" (Supervised, 0)) with Inline;
   --  Whether the program is supervised

   Command_Timeout_Ms : Natural
     with Import, Volatile, Convention => C, External_Name => "ravenbrick_command_timeout";
   --  After which motors without a new command are to stop; 0: they need none

end Ravenbrick.Supervision;
