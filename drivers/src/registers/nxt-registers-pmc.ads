--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Power management controller (datasheet, chapter PMC): only clocks of peripherals.

with System;

package NXT.Registers.PMC is

   type Peripheral is record
      Enable_System_Clock : Word with Atomic;
      Enable_Clock        : Word with Atomic;
      Disable_Clock       : Word with Atomic;
      Clock_Status        : Word with Atomic;
   end record;

   for Peripheral use record
      Enable_System_Clock at 16#00# range 0 .. 31;
      Enable_Clock        at 16#10# range 0 .. 31;
      Disable_Clock       at 16#14# range 0 .. 31;
      Clock_Status        at 16#18# range 0 .. 31;
   end record;

   PMC : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFF_FC00#);

end NXT.Registers.PMC;
