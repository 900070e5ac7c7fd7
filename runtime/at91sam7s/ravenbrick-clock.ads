--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The clock: the periodic interval timer, which counts the master clock divided by 16 and is
--  never reloaded, extended from 32 to 64 bits in software. No interrupt belongs to it.

with Ravenbrick.Threads;

package Ravenbrick.Clock is
   pragma Preelaborate;

   subtype Units is Threads.Units;

   Units_Per_Tick : constant := 7;

   procedure Start with Export, Convention => C, External_Name => "ravenbrick_start_clock";
   --  Start at zero

   function Now return Units;
   --  Callable from any context. The clock must be read or Observe be called at least once in
   --  1_430 s, the period of the 32-bit count.

   procedure Observe with Inline;
   --  Note the count so that the next wrap is seen; interrupts are masked

end Ravenbrick.Clock;
