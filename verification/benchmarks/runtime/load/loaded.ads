--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Latency of a handler of the highest level at random instants while tasks use every service of
--  the kernel: what it grows by is the longest time for which the kernel masks interrupts

with System;

with Series; use Series;

package Loaded is

   Results : Summary
     with Export, Convention => C, External_Name => "results";

   Finished : Boolean := False
     with Volatile, Export, Convention => C, External_Name => "finished";

   Samples : constant := 20_000;

   task Driver with Priority => 10, Storage_Size => 1024;
   task Suspended with Priority => 12, Storage_Size => 768;
   task Waiting with Priority => 13, Storage_Size => 768;

   task type Sleeper (Level : System.Priority)
     with Priority => Level, Storage_Size => 768;

   Sleeper_1 : Sleeper (11);
   Sleeper_2 : Sleeper (11);
   Sleeper_3 : Sleeper (14);
   Sleeper_4 : Sleeper (15);
   Sleeper_5 : Sleeper (16);
   Sleeper_6 : Sleeper (17);

end Loaded;
