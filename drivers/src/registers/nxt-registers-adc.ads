--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Analogue-to-digital converter of the chip (datasheet, chapter ADC), 10 bits, 3.3 V at full
--  scale. The sensors' analogue lines are not here: the co-processor converts them.

with System;

package NXT.Registers.ADC is

   subtype Channel is Natural range 0 .. 7;
   type Channel_Words is array (Channel) of Word with Atomic_Components;

   type Peripheral is record
      Control         : Word with Atomic;
      Mode            : Word with Atomic;
      Enable_Channel  : Word with Atomic;
      Disable_Channel : Word with Atomic;
      Status          : Word with Atomic;
      Data            : Channel_Words;
   end record;
   --  Status: bit N while Data (N) holds a conversion that was not read; reading clears it.

   for Peripheral use record
      Control         at 16#00# range 0 .. 31;
      Mode            at 16#04# range 0 .. 31;
      Enable_Channel  at 16#10# range 0 .. 31;
      Disable_Channel at 16#14# range 0 .. 31;
      Status          at 16#1C# range 0 .. 31;
      Data            at 16#30# range 0 .. 255;
   end record;

   ADC : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFD_8000#);

   --  Control
   Start : constant Word := Bit (1);

   --  Mode: the clock is the master clock divided by ten, 4.8 MHz (at most 5); 21 us to start up,
   --  0.8 us to sample and hold.
   Ten_Bits : constant Word := 4 * Bit (8) + 12 * Bit (16) + 3 * Bit (24);

   Bluetooth_Channel : constant Channel := 6;
   --  High while the module is in stream mode.

   type Sensor_Channels is array (Sensor_Id) of Channel;
   Digital_1 : constant Sensor_Channels := (1, 2, 3, 7);
   --  Second digital lines of the sensor ports.

end NXT.Registers.ADC;
