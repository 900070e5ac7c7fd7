--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Timer counter channels 1 and 2 (datasheet, chapter TC), which beat the time of the sensor ports'
--  soft two-wire buses and of colour sensors. Channel 0 belongs to the run-time.

with System;

package NXT.Registers.TC is

   type Peripheral is record
      Control           : Word with Atomic;
      Mode              : Word with Atomic;
      Compare           : Word with Atomic;
      Status            : Word with Atomic;
      Enable_Interrupt  : Word with Atomic;
      Disable_Interrupt : Word with Atomic;
   end record;

   for Peripheral use record
      Control           at 16#00# range 0 .. 31;
      Mode              at 16#04# range 0 .. 31;
      Compare           at 16#1C# range 0 .. 31;
      Status            at 16#20# range 0 .. 31;
      Enable_Interrupt  at 16#24# range 0 .. 31;
      Disable_Interrupt at 16#28# range 0 .. 31;
   end record;

   TC1 : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFA_0040#);
   TC2 : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFA_0080#);

   --  Control
   Enable  : constant Word := Bit (0);
   Disable : constant Word := Bit (1);
   Trigger : constant Word := Bit (2);

   --  Mode: waveform, up to Compare and again from 0, half the master clock
   Repeating    : constant Word := Bit (15) or Bit (14);
   Clock_Hz     : constant := Clock_Frequency / 2;

   --  Status and interrupts; reading the status clears it
   Compared : constant Word := Bit (4);

end NXT.Registers.TC;
