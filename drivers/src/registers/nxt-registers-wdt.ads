--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Watchdog timer (datasheet, chapter WDT). The mode register takes one write, which belongs to the
--  start of the program.

with System;

package NXT.Registers.WDT is

   type Peripheral is record
      WDT_CR : Word with Atomic;  --  control
      WDT_MR : Word with Atomic;  --  mode, one write after a reset
      WDT_SR : Word with Atomic;  --  status
   end record;

   WDT : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFF_FD40#);

   Restart  : constant Word := 16#A500_0001#;  --  KEY, WDRSTT
   --  WDT_CR: key and bit.

   Disabled : constant Word := Bit (15);  --  WDDIS
   --  Mode.

end NXT.Registers.WDT;
