--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Every service of the kernel in the situation in which it takes longest: with every other task in
--  the queue that it searches, a more urgent task to switch to, and a clock whose count has just
--  begun again. The environment task directs four actors of one priority above its own. At most
--  three of them are ahead of a task that is put into a queue.

with System;

package Worst_Cases is

   Wraps : constant := 4;
   --  Of the clock's count; the scenes are played once for each

   Finished : Boolean := False
     with Volatile, Export, Convention => C, External_Name => "finished";

   procedure Play;

   Actor_Priority : constant System.Priority := 10;

   type Actor_Number is range 1 .. 4;

   task type Actor (Number : Actor_Number)
     with Priority => Actor_Priority, Storage_Size => 1024;

   Actor_1 : Actor (1);
   Actor_2 : Actor (2);
   Actor_3 : Actor (3);
   Actor_4 : Actor (4);

end Worst_Cases;
