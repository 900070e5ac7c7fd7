--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The clock: the periodic interval timer, which counts the master clock divided by 16 and is
--  never reloaded, extended from 32 to 64 bits in software. No interrupt belongs to it.

with Interfaces;

with Ravenbrick.Threads;

package Ravenbrick.Clock is
   pragma Preelaborate;

   subtype Units is Threads.Units;
   use type Threads.Units;

   Units_Per_Tick : constant := 7;

   procedure Start with Export, Convention => C, External_Name => "ravenbrick_start_clock";
   --  Start at zero

   function Now return Units
     with Post => Now'Result >= 0;
   --  Callable from any context. The clock must be read or Observe be called at least once in
   --  1_430 s, the period of the 32-bit count.

   subtype Count is Interfaces.Unsigned_32;

   procedure Observe (Now : out Units; At_Count : out Count) with Inline_Always;
   --  The clock and the hardware count that it was made of, noted so that the next wrap is seen.
   --  Interrupts are masked.

   function Since (Start : Count) return Units with Inline_Always;
   --  Time since the hardware count was Start, less than its period

end Ravenbrick.Clock;
