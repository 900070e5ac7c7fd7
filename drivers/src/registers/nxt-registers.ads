--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Registers of the AT91SAM7S256 that the drivers touch, one child package per peripheral.
--  Addresses and bits: AT91SAM7S datasheet (Atmel document 6175). The run-time has the clock, the
--  alarm and the interrupt controller to itself.

with Interfaces;

package NXT.Registers with Pure is

   subtype Word is Interfaces.Unsigned_32;
   use type Word;

   subtype Line is Natural range 0 .. 31;

   function Bit (Number : Line) return Word is (2 ** Number);

   function Has (Value, Mask : Word) return Boolean is ((Value and Mask) /= 0);
   --  Whether at least one bit of Mask is set in Value.

   --  Peripheral identifiers (datasheet, chapter Peripherals)
   PIOA_Id   : constant := 2;
   ADC_Id    : constant := 4;
   SPI_Id    : constant := 5;
   USART0_Id : constant := 6;
   USART1_Id : constant := 7;
   SSC_Id    : constant := 8;
   TWI_Id    : constant := 9;
   UDP_Id    : constant := 11;
   TC1_Id    : constant := 13;
   TC2_Id    : constant := 14;

end NXT.Registers;
