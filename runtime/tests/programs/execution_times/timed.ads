--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Tasks and a handler of known loads, which read their own and each other's execution times

package Timed is

   type Units is array (1 .. 6) of Long_Long_Integer with Convention => C;

   Clocks : Units := (others => 0)
     with Volatile, Export, Convention => C, External_Name => "clocks";
   --  Execution times at one instant: of Quick, Slow, the environment task, the interrupt of the
   --  timer, the alarm's, and all interrupts

   Own : Units := (others => 0)
     with Volatile, Export, Convention => C, External_Name => "own";
   --  What passed for Quick: least and most of a job of 100 rounds, and of the same job on the
   --  wall clock

   Jobs : Natural := 0
     with Volatile, Export, Convention => C, External_Name => "jobs";

   procedure Work with No_Return;
   --  Of the environment task, for ever

   task Quick with Priority => 12, Storage_Size => 1024;
   task Slow with Priority => 10, Storage_Size => 1024;

end Timed;
