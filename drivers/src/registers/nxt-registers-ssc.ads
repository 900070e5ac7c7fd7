--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Synchronous serial controller (datasheet, chapter SSC) with its channel of the peripheral DMA
--  controller, as the sender of the sound line: words of 32 bits, the highest first, no gaps.

with System;

package NXT.Registers.SSC is

   type Peripheral is record
      Control           : Word with Atomic;
      Clock_Mode        : Word with Atomic;
      Transmit_Clock    : Word with Atomic;
      Transmit_Frame    : Word with Atomic;
      Status            : Word with Atomic;
      Enable_Interrupt  : Word with Atomic;
      Disable_Interrupt : Word with Atomic;
      DMA_Address       : System.Address with Atomic;
      DMA_Count         : Word with Atomic;
      DMA_Next_Address  : System.Address with Atomic;
      DMA_Next_Count    : Word with Atomic;
      DMA_Control       : Word with Atomic;
   end record;

   for Peripheral use record
      Control           at 16#000# range 0 .. 31;
      Clock_Mode        at 16#004# range 0 .. 31;
      Transmit_Clock    at 16#018# range 0 .. 31;
      Transmit_Frame    at 16#01C# range 0 .. 31;
      Status            at 16#040# range 0 .. 31;
      Enable_Interrupt  at 16#044# range 0 .. 31;
      Disable_Interrupt at 16#048# range 0 .. 31;
      DMA_Address       at 16#108# range 0 .. 31;
      DMA_Count         at 16#10C# range 0 .. 31;
      DMA_Next_Address  at 16#118# range 0 .. 31;
      DMA_Next_Count    at 16#11C# range 0 .. 31;
      DMA_Control       at 16#120# range 0 .. 31;
   end record;

   SSC : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFD_4000#);

   --  Control
   Transmit_Enable  : constant Word := Bit (8);
   Transmit_Disable : constant Word := Bit (9);
   Reset            : constant Word := Bit (15);

   --  Clock_Mode: bits at the master clock divided by twice this; Transmit_Clock 0 takes it

   --  Transmit_Frame
   Bits_Per_Word : constant := 32;
   Sound_Words   : constant Word := (Bits_Per_Word - 1) or Bit (7);

   --  Status and interrupts
   DMA_Ended   : constant Word := Bit (2);
   DMA_Drained : constant Word := Bit (3);
   --  Both buffers are through.

   --  DMA_Control
   DMA_Transmit_Enable  : constant Word := Bit (8);
   DMA_Transmit_Disable : constant Word := Bit (9);

end NXT.Registers.SSC;
