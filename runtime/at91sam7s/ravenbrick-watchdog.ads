--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Two timers that end a program which nobody supervises any more. The real-time timer requests the
--  fast interrupt, which no task and no handler masks; the program then fails as by an exception.
--  The watchdog resets the processor when even that does not happen. The boot monitor has switched
--  it off for programs in RAM (datasheet, chapter SAM-BA Boot).

package Ravenbrick.Watchdog is
   pragma Preelaborate;

   procedure Arm;
   --  From now on the fast interrupt comes 50 ms after the last Restart. The slow clock of 22 to
   --  42 kHz makes them 39 to 75 ms. Not when the program has a handler of the system's interrupt.

   procedure Restart with Inline;

   function Was_Reset return Boolean;
   --  Whether the watchdog has reset the processor: the program starts anew

end Ravenbrick.Watchdog;
