--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Times of accesses to RAM, peripherals and flash, and of instructions; of programming a page.

package Memory_Timing is

   procedure Measure_RAM;
   --  Instructions and accesses from code in RAM, and data in flash.

   procedure Measure_Flash;
   --  Code in a page of the flash, which is programmed for each sequence and restored in the end.

end Memory_Timing;
