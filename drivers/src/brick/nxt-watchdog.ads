--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The processor's watchdog: a program that does not restart it in time is reset, and starts anew.
--
--  It is switched on when the program is linked, since its mode can be set only once:
--
--     package Linker is
--        for Default_Switches ("Ada") use ("-Wl,--defsym=ravenbrick_watchdog_mode=0x1FFF20FF");
--
--  The last twelve bits are the time to the reset in units of 1/256 s less one; here 1 s, by a
--  clock of 22 to 42 kHz in place of 32.8 kHz (datasheet, chapter WDT). Only in images in flash:
--  the boot monitor, which starts images in RAM, has switched it off for good.

package NXT.Watchdog is

   function Enabled return Boolean;

   procedure Restart;
   --  Best called by the task with the longest period that must not be missed. No effect unless
   --  Enabled.

end NXT.Watchdog;
