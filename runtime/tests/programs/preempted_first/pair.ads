--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Two busy tasks of one priority and a periodic one above them: a preempted task goes on before
--  its equals (RM D.2.3)

package Pair is

   First_Count : Natural := 0 with Volatile, Export, Convention => C, External_Name => "first";
   Second_Count : Natural := 0 with Volatile, Export, Convention => C, External_Name => "second";
   Tick_Count : Natural := 0 with Volatile, Export, Convention => C, External_Name => "ticks";

   task First with Priority => 10, Storage_Size => 512;
   task Second with Priority => 10, Storage_Size => 512;
   task Ticker with Priority => 20, Storage_Size => 512;

end Pair;
