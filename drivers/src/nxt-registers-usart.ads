--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Serial line 1 (datasheet, chapter USART) with its channels of the peripheral DMA controller, as
--  the line to the Bluetooth module: 8 bits, no parity, with the handshake of RTS and CTS.

with System;

package NXT.Registers.USART is

   type Peripheral is record
      Control              : Word with Atomic;
      Mode                 : Word with Atomic;
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

   USART1 : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFC_4000#);

   --  Control
   Reset_Receiver     : constant Word := Bit (2);
   Reset_Transmitter  : constant Word := Bit (3);
   Enable_Receiver    : constant Word := Bit (4);
   Disable_Receiver   : constant Word := Bit (5);
   Enable_Transmitter : constant Word := Bit (6);

   --  Mode
   Hardware_Handshake   : constant Word := 2;
   Eight_Bits           : constant Word := 3 * Bit (6);
   No_Parity            : constant Word := 4 * Bit (9);
   Eight_Times_Sampling : constant Word := Bit (19);

   --  Status
   Sent : constant Word := Bit (9);
   --  Nothing is left in the shift register.

   --  DMA_Control
   DMA_Receive_Enable  : constant Word := Bit (0);
   DMA_Receive_Disable : constant Word := Bit (1);
   DMA_Send_Enable     : constant Word := Bit (8);
   DMA_Send_Disable    : constant Word := Bit (9);

end NXT.Registers.USART;
