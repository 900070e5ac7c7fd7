--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Timer counter channels 1 and 2 (datasheet, chapter TC), which clock the sensor ports'
--  soft two-wire buses and of colour sensors. Channel 0 belongs to the run-time.

with System;

package NXT.Registers.TC is

   type Peripheral is record
      TC_CCR : Word with Atomic;  --  control
      TC_CMR : Word with Atomic;  --  mode
      TC_RC  : Word with Atomic;  --  compare value
      TC_SR  : Word with Atomic;  --  status, which reading clears
      TC_IER : Word with Atomic;  --  enables interrupts
   end record;

   for Peripheral use record
      TC_CCR at 16#00# range 0 .. 31;
      TC_CMR at 16#04# range 0 .. 31;
      TC_RC  at 16#1C# range 0 .. 31;
      TC_SR  at 16#20# range 0 .. 31;
      TC_IER at 16#24# range 0 .. 31;
   end record;

   TC1 : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFA_0040#);
   TC2 : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFA_0080#);

   --  TC_CCR
   Enable  : constant Word := Bit (0);  --  CLKEN
   Disable : constant Word := Bit (1);  --  CLKDIS
   Trigger : constant Word := Bit (2);  --  SWTRG

   --  TC_CMR: waveform, up to TC_RC and again from 0, half the master clock
   Repeating    : constant Word := Bit (15) or Bit (14);  --  WAVE, WAVSEL
   Clock_Hz     : constant := Clock_Frequency / 2;

   --  TC_SR and interrupts; reading the status clears it
   Compared : constant Word := Bit (4);  --  CPCS

end NXT.Registers.TC;
