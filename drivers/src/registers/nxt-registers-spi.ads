--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Serial peripheral interface (datasheet, chapter SPI) with its channel of the peripheral DMA
--  controller (chapter PDC), as the master of the display: mode 3, 8 bits, 2 MHz, send only.

with System;

package NXT.Registers.SPI is

   type Peripheral is record
      SPI_CR      : Word with Atomic;            --  control
      SPI_MR      : Word with Atomic;            --  mode
      SPI_TDR     : Word with Atomic;            --  transmit data
      SPI_SR      : Word with Atomic;            --  status
      SPI_IER     : Word with Atomic;            --  enables interrupts
      SPI_IDR     : Word with Atomic;            --  disables interrupts
      SPI_IMR     : Word with Atomic;            --  enabled interrupts
      SPI_CSR2    : Word with Atomic;            --  timing of chip select 2
      PERIPH_TPR  : System.Address with Atomic;  --  DMA: address
      PERIPH_TCR  : Word with Atomic;            --  DMA: count
      PERIPH_PTCR : Word with Atomic;            --  DMA: control
   end record;

   for Peripheral use record
      SPI_CR      at 16#000# range 0 .. 31;
      SPI_MR      at 16#004# range 0 .. 31;
      SPI_TDR     at 16#00C# range 0 .. 31;
      SPI_SR      at 16#010# range 0 .. 31;
      SPI_IER     at 16#014# range 0 .. 31;
      SPI_IDR     at 16#018# range 0 .. 31;
      SPI_IMR     at 16#01C# range 0 .. 31;
      SPI_CSR2    at 16#038# range 0 .. 31;
      PERIPH_TPR  at 16#108# range 0 .. 31;
      PERIPH_TCR  at 16#10C# range 0 .. 31;
      PERIPH_PTCR at 16#120# range 0 .. 31;
   end record;

   SPI : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFE_0000#);

   --  SPI_CR
   Enable  : constant Word := Bit (0);  --  SPIEN
   Disable : constant Word := Bit (1);  --  SPIDIS
   Reset   : constant Word := Bit (7);  --  SWRST

   --  SPI_MR: master, no mode fault (the display's select line is driven by the SPI alone), and
   --  fixed selection of line 2, whose code is 1011
   Master              : constant Word := Bit (0);            --  MSTR
   Ignore_Mode_Fault   : constant Word := Bit (4);            --  MODFDIS
   Select_Line_2       : constant Word := 2#1011# * 2 ** 16;  --  PCS

   --  SPI_CSR2: clock idles high, data is stable at its rising edge; 48.05 MHz / 24 = 2 MHz
   Clock_Idles_High : constant Word := Bit (0);  --  CPOL
   Clock_Divider    : constant := 24;            --  SCBR
   Display_Timing   : constant Word := Clock_Idles_High or Clock_Divider * 2 ** 8;

   --  SPI_SR and interrupts
   Transmit_Ready : constant Word := Bit (1);  --  TDRE
   DMA_Ended      : constant Word := Bit (5);  --  ENDTX
   Nothing_Left   : constant Word := Bit (9);  --  TXEMPTY
   --  Nothing_Left: the last bit has left the shift register.

   --  PERIPH_PTCR
   DMA_Transmit_Enable  : constant Word := Bit (8);  --  TXTEN
   DMA_Transmit_Disable : constant Word := Bit (9);  --  TXTDIS

end NXT.Registers.SPI;
