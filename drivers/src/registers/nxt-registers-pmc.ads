--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Power management controller (datasheet, chapter PMC): only clocks of peripherals.

with System;

package NXT.Registers.PMC is

   type Peripheral is record
      PMC_SCER : Word with Atomic;  --  enables system clocks
      PMC_PCER : Word with Atomic;  --  enables clocks of peripherals
   end record;

   for Peripheral use record
      PMC_SCER at 16#00# range 0 .. 31;
      PMC_PCER at 16#10# range 0 .. 31;
   end record;

   PMC : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFF_FC00#);

end NXT.Registers.PMC;
