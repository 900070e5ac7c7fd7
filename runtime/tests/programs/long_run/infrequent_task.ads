--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A task that wakes up every 100 s, over the wrap of the 32-bit hardware count at 1_430 s

with Interfaces;

package Infrequent_Task is

   Jobs : Natural := 0 with Volatile, Export, Convention => C, External_Name => "jobs";

   Readings : array (0 .. 19) of Interfaces.Integer_64 := (others => 0)
     with Volatile_Components, Export, Convention => C, External_Name => "readings";
   --  Clock in units after each wake-up

   task Sleeper with Priority => 10, Storage_Size => 512;

end Infrequent_Task;
