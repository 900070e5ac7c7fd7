--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Analogue-to-digital converter of the chip (datasheet, chapter ADC), 10 bits, 3.3 V at full
--  scale. The sensors' analogue lines are not here: the co-processor converts them.

with System;

package NXT.Registers.ADC is

   subtype Channel is Natural range 0 .. 7;
   type Channel_Words is array (Channel) of Word with Atomic_Components;

   type Peripheral is record
      ADC_CR   : Word with Atomic;  --  control
      ADC_MR   : Word with Atomic;  --  mode
      ADC_CHER : Word with Atomic;  --  enables channels
      ADC_CHDR : Word with Atomic;  --  disables channels
      ADC_CDR  : Channel_Words;     --  results of the conversions
   end record;

   for Peripheral use record
      ADC_CR   at 16#00# range 0 .. 31;
      ADC_MR   at 16#04# range 0 .. 31;
      ADC_CHER at 16#10# range 0 .. 31;
      ADC_CHDR at 16#14# range 0 .. 31;
      ADC_CDR  at 16#30# range 0 .. 255;
   end record;

   ADC : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFD_8000#);

   --  ADC_CR
   Start : constant Word := Bit (1);  --  START

   --  ADC_MR: the clock is the master clock divided by ten, 4.8 MHz (at most 5); 21 us to start up,
   --  0.8 us to sample and hold.
   Ten_Bits : constant Word := 4 * Bit (8) + 12 * Bit (16) + 3 * Bit (24);

   Bluetooth_Channel : constant Channel := 6;
   --  High while the module is in stream mode.

   type Sensor_Channels is array (Sensor_Id) of Channel;
   Digital_1 : constant Sensor_Channels := (1, 2, 3, 7);
   --  Second digital lines of the sensor ports.

end NXT.Registers.ADC;
