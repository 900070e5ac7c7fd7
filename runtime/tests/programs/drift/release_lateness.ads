--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A task with a period of a second, for a day; it compares its releases with the clock

package Release_Lateness is

   Jobs : Natural := 0
     with Volatile, Export, Convention => C, External_Name => "jobs";

   type Extremes is array (1 .. 2) of Long_Long_Integer with Convention => C;

   Lateness : Extremes := (Long_Long_Integer'Last, Long_Long_Integer'First)
     with Volatile, Export, Convention => C, External_Name => "lateness";
   --  Least and most, in units, of the clock behind the nominal release

   task Seconds_Task with Priority => 10, Storage_Size => 1024;

end Release_Lateness;
