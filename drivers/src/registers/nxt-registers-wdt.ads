--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Watchdog timer (datasheet, chapter WDT). The mode register takes one write, which belongs to the
--  start of the program.

with System;

package NXT.Registers.WDT is

   type Peripheral is record
      Control : Word with Atomic;
      Mode    : Word with Atomic;
      Status  : Word with Atomic;
   end record;

   WDT : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFF_FD40#);

   Restart  : constant Word := 16#A500_0001#;
   --  Control: key and bit.

   Disabled : constant Word := Bit (15);
   --  Mode.

end NXT.Registers.WDT;
