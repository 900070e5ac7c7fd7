--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Serial peripheral interface (datasheet, chapter SPI) with its channel of the peripheral DMA
--  controller (chapter PDC), as the master of the display: mode 3, 8 bits, 2 MHz, send only.

with System;

package NXT.Registers.SPI is

   type Peripheral is record
      Control           : Word with Atomic;
      Mode              : Word with Atomic;
      Transmit          : Word with Atomic;
      Status            : Word with Atomic;
      Enable_Interrupt  : Word with Atomic;
      Disable_Interrupt : Word with Atomic;
      Interrupt_Mask    : Word with Atomic;
      Chip_Select_2     : Word with Atomic;
      DMA_Address       : System.Address with Atomic;
      DMA_Count         : Word with Atomic;
      DMA_Control       : Word with Atomic;
   end record;

   for Peripheral use record
      Control           at 16#000# range 0 .. 31;
      Mode              at 16#004# range 0 .. 31;
      Transmit          at 16#00C# range 0 .. 31;
      Status            at 16#010# range 0 .. 31;
      Enable_Interrupt  at 16#014# range 0 .. 31;
      Disable_Interrupt at 16#018# range 0 .. 31;
      Interrupt_Mask    at 16#01C# range 0 .. 31;
      Chip_Select_2     at 16#038# range 0 .. 31;
      DMA_Address       at 16#108# range 0 .. 31;
      DMA_Count         at 16#10C# range 0 .. 31;
      DMA_Control       at 16#120# range 0 .. 31;
   end record;

   SPI : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFE_0000#);

   --  Control
   Enable  : constant Word := Bit (0);
   Disable : constant Word := Bit (1);
   Reset   : constant Word := Bit (7);

   --  Mode: master, no mode fault (the display's select line is driven by the SPI alone), and
   --  fixed selection of line 2, whose code is 1011
   Master              : constant Word := Bit (0);
   Ignore_Mode_Fault   : constant Word := Bit (4);
   Select_Line_2       : constant Word := 2#1011# * 2 ** 16;

   --  Chip_Select_2: clock idles high, data is stable at its rising edge; 48.05 MHz / 24 = 2 MHz
   Clock_Idles_High : constant Word := Bit (0);
   Clock_Divider    : constant := 24;
   Display_Timing   : constant Word := Clock_Idles_High or Clock_Divider * 2 ** 8;

   --  Status and interrupts
   Transmit_Ready : constant Word := Bit (1);
   DMA_Ended      : constant Word := Bit (5);
   Nothing_Left   : constant Word := Bit (9);
   --  Nothing_Left: the last bit has left the shift register.

   --  DMA_Control
   DMA_Transmit_Enable  : constant Word := Bit (8);
   DMA_Transmit_Disable : constant Word := Bit (9);

end NXT.Registers.SPI;
