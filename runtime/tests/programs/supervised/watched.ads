--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A supervisor in place of the drivers' link task, and two tasks with deadlines of 5 ms, of which
--  one goes wrong in its twentieth job, in each tenth, or in all

package Watched is

   type Fault is
     (Nothing, Often_Late, Seldom_Late, Late, Late_Sporadic, Behind, No_Delay, Ends, Overflows,
      Hangs);

   Chosen : Integer := -1
     with Volatile, Export, Convention => C, External_Name => "chosen";
   --  Position of the fault; the test puts it into the image

   task Supervisor with Priority => 30, Storage_Size => 1_024;

   task Sporadic with Priority => 14, Storage_Size => 1_024;
   --  Released by Cyclic where that is not late now and then, busy for 3 ms

   task Cyclic with Priority => 12, Storage_Size => 1_024;
   --  Every 10 ms

end Watched;
