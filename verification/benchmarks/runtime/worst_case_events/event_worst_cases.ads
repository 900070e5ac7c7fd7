--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Timing events in the situations in which they take longest: three others are earlier, or the
--  event becomes the earliest, while the clock's count has just begun again; a handler with a
--  ceiling above the alarm's priority, which expires while the environment task is about to give
--  the processor to four more urgent tasks.

with System;

package Event_Worst_Cases is

   Finished : Boolean := False
     with Volatile, Export, Convention => C, External_Name => "finished";

   procedure Play;

   Listener_Priority : constant System.Priority := 10;

   type Listener_Number is range 1 .. 4;

   task type Listener (Number : Listener_Number)
     with Priority => Listener_Priority, Storage_Size => 1024;

   Listener_1 : Listener (1);
   Listener_2 : Listener (2);
   Listener_3 : Listener (3);
   Listener_4 : Listener (4);

end Event_Worst_Cases;
