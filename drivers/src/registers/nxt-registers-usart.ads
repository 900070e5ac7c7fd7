--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Serial lines (datasheet, chapter USART) with their channels of the peripheral DMA controller: 0
--  is the RS485 pair of sensor port 4, 1 the line to the Bluetooth module.

with System;

package NXT.Registers.USART is

   type Peripheral is record
      Control              : Word with Atomic;
      Mode                 : Word with Atomic;
      Enable_Interrupt     : Word with Atomic;
      Disable_Interrupt    : Word with Atomic;
      Interrupt_Mask       : Word with Atomic;
      Status               : Word with Atomic;
      Baud_Rate            : Word with Atomic;
      Receive_Address      : System.Address with Atomic;
      Receive_Count        : Word with Atomic;
      Send_Address         : System.Address with Atomic;
      Send_Count           : Word with Atomic;
      Receive_Next_Address : System.Address with Atomic;
      Receive_Next_Count   : Word with Atomic;
      Send_Next_Address    : System.Address with Atomic;
      Send_Next_Count      : Word with Atomic;
      DMA_Control          : Word with Atomic;
   end record;

   for Peripheral use record
      Control              at 16#000# range 0 .. 31;
      Mode                 at 16#004# range 0 .. 31;
      Enable_Interrupt     at 16#008# range 0 .. 31;
      Disable_Interrupt    at 16#00C# range 0 .. 31;
      Interrupt_Mask       at 16#010# range 0 .. 31;
      Status               at 16#014# range 0 .. 31;
      Baud_Rate            at 16#020# range 0 .. 31;
      Receive_Address      at 16#100# range 0 .. 31;
      Receive_Count        at 16#104# range 0 .. 31;
      Send_Address         at 16#108# range 0 .. 31;
      Send_Count           at 16#10C# range 0 .. 31;
      Receive_Next_Address at 16#110# range 0 .. 31;
      Receive_Next_Count   at 16#114# range 0 .. 31;
      Send_Next_Address    at 16#118# range 0 .. 31;
      Send_Next_Count      at 16#11C# range 0 .. 31;
      DMA_Control          at 16#120# range 0 .. 31;
   end record;

   USART0 : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFC_0000#);
   USART1 : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFC_4000#);

   --  Control
   Reset_Receiver     : constant Word := Bit (2);
   Reset_Transmitter  : constant Word := Bit (3);
   Enable_Receiver    : constant Word := Bit (4);
   Disable_Receiver   : constant Word := Bit (5);
   Enable_Transmitter : constant Word := Bit (6);
   Disable_Both       : constant Word := Bit (5) or Bit (7);
   Reset_Errors       : constant Word := Bit (8);

   --  Mode
   RS485_Direction_Line : constant Word := 1;
   Hardware_Handshake   : constant Word := 2;
   Eight_Bits           : constant Word := 3 * Bit (6);
   No_Parity            : constant Word := 4 * Bit (9);
   Local_Loop           : constant Word := 2 * Bit (14);
   Eight_Times_Sampling : constant Word := Bit (19);

   --  Baud_Rate: a divider in sixteen bits, eighths from bit 16 on
   Fraction_Place : constant := 16;

   --  Status and interrupts
   Receive_Ended : constant Word := Bit (3);
   Send_Ended    : constant Word := Bit (4);
   --  Of DMA buffers.
   Overrun       : constant Word := Bit (5);
   Framing_Error : constant Word := Bit (6);
   Sent : constant Word := Bit (9);
   --  Nothing is left in the shift register.

   --  DMA_Control
   DMA_Receive_Enable  : constant Word := Bit (0);
   DMA_Receive_Disable : constant Word := Bit (1);
   DMA_Send_Enable     : constant Word := Bit (8);
   DMA_Send_Disable    : constant Word := Bit (9);

end NXT.Registers.USART;
