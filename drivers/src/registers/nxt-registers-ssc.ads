--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Synchronous serial controller (datasheet, chapter SSC) with its channel of the peripheral DMA
--  controller, as the sender of the sound line: words of 32 bits, the highest first, no gaps.

with System;

package NXT.Registers.SSC is

   type Peripheral is record
      SSC_CR      : Word with Atomic;            --  control
      SSC_CMR     : Word with Atomic;            --  clock divider
      SSC_TFMR    : Word with Atomic;            --  transmit frame
      SSC_SR      : Word with Atomic;            --  status
      SSC_IER     : Word with Atomic;            --  enables interrupts
      SSC_IDR     : Word with Atomic;            --  disables interrupts
      PERIPH_TPR  : System.Address with Atomic;  --  DMA: address
      PERIPH_TCR  : Word with Atomic;            --  DMA: count
      PERIPH_TNPR : System.Address with Atomic;  --  DMA: next address
      PERIPH_TNCR : Word with Atomic;            --  DMA: next count
      PERIPH_PTCR : Word with Atomic;            --  DMA: control
   end record;

   for Peripheral use record
      SSC_CR      at 16#000# range 0 .. 31;
      SSC_CMR     at 16#004# range 0 .. 31;
      SSC_TFMR    at 16#01C# range 0 .. 31;
      SSC_SR      at 16#040# range 0 .. 31;
      SSC_IER     at 16#044# range 0 .. 31;
      SSC_IDR     at 16#048# range 0 .. 31;
      PERIPH_TPR  at 16#108# range 0 .. 31;
      PERIPH_TCR  at 16#10C# range 0 .. 31;
      PERIPH_TNPR at 16#118# range 0 .. 31;
      PERIPH_TNCR at 16#11C# range 0 .. 31;
      PERIPH_PTCR at 16#120# range 0 .. 31;
   end record;

   SSC : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFD_4000#);

   --  SSC_CR
   Transmit_Enable  : constant Word := Bit (8);   --  TXEN
   Transmit_Disable : constant Word := Bit (9);   --  TXDIS
   Reset            : constant Word := Bit (15);  --  SWRST

   --  SSC_CMR: bits at the master clock divided by twice this, which SSC_TCMR selects when it is 0,
   --  as after a reset

   --  SSC_TFMR
   Bits_Per_Word : constant := 32;
   Sound_Words   : constant Word := (Bits_Per_Word - 1) or Bit (7);  --  DATLEN, MSBF

   --  SSC_SR and interrupts
   DMA_Ended   : constant Word := Bit (2);  --  ENDTX
   DMA_Drained : constant Word := Bit (3);  --  TXBUFE
   --  Both buffers are through.

   --  PERIPH_PTCR
   DMA_Transmit_Enable  : constant Word := Bit (8);  --  TXTEN
   DMA_Transmit_Disable : constant Word := Bit (9);  --  TXTDIS

end NXT.Registers.SSC;
