--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Tasks below an interrupt that is more urgent than the alarm. Each sixth one releases Server,
--  whose jobs wait for a time inside. Both note how late they are.

with Interfaces;

package Workers is
   pragma Elaborate_Body;

   Shortest_Latency : Interfaces.Unsigned_32 := Interfaces.Unsigned_32'Last
     with Volatile, Export, Convention => C, External_Name => "shortest_latency";
   Longest_Latency : Interfaces.Unsigned_32 := 0
     with Volatile, Export, Convention => C, External_Name => "longest_latency";
   --  In counts of two cycles, from the timer's request until the handler reads it

   Longest_Response : Interfaces.Unsigned_32 := 0
     with Volatile, Export, Convention => C, External_Name => "longest_response";
   --  In the same, from the release of Server to the end of its job

   task Control with Priority => 12, Storage_Size => 1_024;
   task Server with Priority => 11, Storage_Size => 1_024;
   task Display with Priority => 10, Storage_Size => 1_024;

end Workers;
