--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Serial lines (datasheet, chapter USART) with their channels of the peripheral DMA controller: 0
--  is the RS485 pair of sensor port 4, 1 the line to the Bluetooth module.

with System;

package NXT.Registers.USART is

   type Peripheral is record
      US_CR       : Word with Atomic;            --  control
      US_MR       : Word with Atomic;            --  mode
      US_IER      : Word with Atomic;            --  enables interrupts
      US_IDR      : Word with Atomic;            --  disables interrupts
      US_IMR      : Word with Atomic;            --  enabled interrupts
      US_CSR      : Word with Atomic;            --  channel status
      US_BRGR     : Word with Atomic;            --  baud rate
      PERIPH_RPR  : System.Address with Atomic;  --  DMA, received bytes: address
      PERIPH_RCR  : Word with Atomic;            --  count
      PERIPH_TPR  : System.Address with Atomic;  --  DMA, bytes to send: address
      PERIPH_TCR  : Word with Atomic;            --  count
      PERIPH_RNPR : System.Address with Atomic;  --  next address
      PERIPH_RNCR : Word with Atomic;            --  next count
      PERIPH_PTCR : Word with Atomic;            --  DMA control
   end record;

   for Peripheral use record
      US_CR       at 16#000# range 0 .. 31;
      US_MR       at 16#004# range 0 .. 31;
      US_IER      at 16#008# range 0 .. 31;
      US_IDR      at 16#00C# range 0 .. 31;
      US_IMR      at 16#010# range 0 .. 31;
      US_CSR      at 16#014# range 0 .. 31;
      US_BRGR     at 16#020# range 0 .. 31;
      PERIPH_RPR  at 16#100# range 0 .. 31;
      PERIPH_RCR  at 16#104# range 0 .. 31;
      PERIPH_TPR  at 16#108# range 0 .. 31;
      PERIPH_TCR  at 16#10C# range 0 .. 31;
      PERIPH_RNPR at 16#110# range 0 .. 31;
      PERIPH_RNCR at 16#114# range 0 .. 31;
      PERIPH_PTCR at 16#120# range 0 .. 31;
   end record;

   USART0 : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFC_0000#);
   USART1 : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFC_4000#);

   --  US_CR
   Reset_Receiver     : constant Word := Bit (2);             --  RSTRX
   Reset_Transmitter  : constant Word := Bit (3);             --  RSTTX
   Enable_Receiver    : constant Word := Bit (4);             --  RXEN
   Enable_Transmitter : constant Word := Bit (6);             --  TXEN
   Disable_Both       : constant Word := Bit (5) or Bit (7);  --  RXDIS, TXDIS
   Reset_Errors       : constant Word := Bit (8);             --  RSTSTA

   --  US_MR
   RS485_Direction_Line : constant Word := 1;             --  USART_MODE
   Hardware_Handshake   : constant Word := 2;             --  USART_MODE
   Eight_Bits           : constant Word := 3 * Bit (6);   --  CHRL
   No_Parity            : constant Word := 4 * Bit (9);   --  PAR
   Local_Loop           : constant Word := 2 * Bit (14);  --  CHMODE
   Eight_Times_Sampling : constant Word := Bit (19);      --  OVER

   --  US_BRGR: a divider in sixteen bits, eighths from bit 16 on
   Fraction_Place : constant := 16;  --  FP

   --  US_CSR and interrupts
   Receive_Ended : constant Word := Bit (3);  --  ENDRX
   Send_Ended    : constant Word := Bit (4);  --  ENDTX
   --  Of DMA buffers.
   Overrun       : constant Word := Bit (5);  --  OVRE
   Framing_Error : constant Word := Bit (6);  --  FRAME
   Sent : constant Word := Bit (9);           --  TXEMPTY
   --  Nothing is left in the shift register.

   --  PERIPH_PTCR
   DMA_Receive_Enable  : constant Word := Bit (0);  --  RXTEN
   DMA_Receive_Disable : constant Word := Bit (1);  --  RXTDIS
   DMA_Send_Enable     : constant Word := Bit (8);  --  TXTEN
   DMA_Send_Disable    : constant Word := Bit (9);  --  TXTDIS

end NXT.Registers.USART;
