--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Parallel input and output controller A (datasheet, chapter PIO) and how the brick wires it.
--  Writing ones to a pair such as PIO_OER and PIO_ODR changes those lines only, so
--  no read-modify-write is needed and drivers do not disturb each other.

with System;

package NXT.Registers.PIO with Preelaborate is

   type Peripheral is record
      PIO_PER  : Word with Atomic;  --  gives lines to this controller
      PIO_PDR  : Word with Atomic;  --  gives lines to their peripheral
      PIO_OER  : Word with Atomic;  --  enables outputs
      PIO_ODR  : Word with Atomic;  --  disables outputs
      PIO_IFER : Word with Atomic;  --  enables the glitch filter
      PIO_SODR : Word with Atomic;  --  sets outputs
      PIO_CODR : Word with Atomic;  --  clears outputs
      PIO_PDSR : Word with Atomic;  --  levels of the pins
      PIO_IER  : Word with Atomic;  --  enables interrupts at edges
      PIO_ISR  : Word with Atomic;  --  lines with an edge since the last reading, which clears it
      PIO_MDER : Word with Atomic;  --  makes outputs open drain
      PIO_MDDR : Word with Atomic;  --  makes outputs push-pull
      PIO_PUDR : Word with Atomic;  --  disables pull-ups
      PIO_ASR  : Word with Atomic;  --  selects peripheral A
      PIO_BSR  : Word with Atomic;  --  selects peripheral B
   end record;

   for Peripheral use record
      PIO_PER  at 16#00# range 0 .. 31;
      PIO_PDR  at 16#04# range 0 .. 31;
      PIO_OER  at 16#10# range 0 .. 31;
      PIO_ODR  at 16#14# range 0 .. 31;
      PIO_IFER at 16#20# range 0 .. 31;
      PIO_SODR at 16#30# range 0 .. 31;
      PIO_CODR at 16#34# range 0 .. 31;
      PIO_PDSR at 16#3C# range 0 .. 31;
      PIO_IER  at 16#40# range 0 .. 31;
      PIO_ISR  at 16#4C# range 0 .. 31;
      PIO_MDER at 16#50# range 0 .. 31;
      PIO_MDDR at 16#54# range 0 .. 31;
      PIO_PUDR at 16#60# range 0 .. 31;
      PIO_ASR  at 16#70# range 0 .. 31;
      PIO_BSR  at 16#74# range 0 .. 31;
   end record;

   PIOA : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFF_F400#);

   --  Lines as the brick wires them (LEGO MINDSTORMS NXT Hardware Developer Kit, schematics)
   TWI_Data         : constant Line := 3;
   TWI_Clock        : constant Line := 4;
   RS485_Receive    : constant Line := 5;
   RS485_Send       : constant Line := 6;
   RS485_Direction  : constant Line := 7;
   Display_Select   : constant Line := 10;
   Display_Data     : constant Line := 12;
   --  Low for a command, high for pixels; the line is the SPI's unused input.
   SPI_Output       : constant Line := 13;
   SPI_Clock        : constant Line := 14;

   Bluetooth_Reset  : constant Line := 11;
   --  Active low.
   USB_Pull_Up      : constant Line := 16;
   --  Low: the brick appears on the bus.
   Sound_Output     : constant Line := 17;
   Bluetooth_Input  : constant Line := 21;
   Bluetooth_Output : constant Line := 22;
   Bluetooth_Ready  : constant Line := 24;
   Bluetooth_Go     : constant Line := 25;
   --  Request and clear to send, active low.
   Bluetooth_Stream : constant Line := 27;
   --  High: the chip wants the stream mode.
   Bluetooth_Select : constant Line := 31;
   --  Chip select of the module's own memory, active low: never used.

   type Motor_Lines is array (Motor_Id) of Line;
   Tachometer : constant Motor_Lines := (Motor_A => 15, Motor_B => 26, Motor_C => 0);
   Direction  : constant Motor_Lines := (Motor_A => 1, Motor_B => 9, Motor_C => 8);

   type Sensor_Lines is array (Sensor_Id) of Line;
   Digital_0  : constant Sensor_Lines := (23, 28, 29, 30);
   Digital_1  : constant Sensor_Lines := (18, 19, 20, 2);

end NXT.Registers.PIO;
