--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A task whose recursion goes one level deeper in each job, until its stack is full

package Overflowing is

   Depth : Natural := 0
     with Volatile, Export, Convention => C, External_Name => "depth";

   task Recursive_Task with Priority => 12, Storage_Size => 1024 is
      pragma Task_Name ("recursive");
   end Recursive_Task;

end Overflowing;
