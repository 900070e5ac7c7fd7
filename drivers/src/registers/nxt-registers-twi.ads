--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Two-wire interface (datasheet, chapter TWI), used as the bus master towards the co-processor.

with System;

package NXT.Registers.TWI is

   type Peripheral is record
      TWI_CR   : Word with Atomic;  --  control
      TWI_MMR  : Word with Atomic;  --  master mode
      TWI_CWGR : Word with Atomic;  --  clock waveform
      TWI_SR   : Word with Atomic;  --  status
      TWI_IER  : Word with Atomic;  --  enables interrupts
      TWI_IDR  : Word with Atomic;  --  disables interrupts
      TWI_IMR  : Word with Atomic;  --  enabled interrupts
      TWI_RHR  : Word with Atomic;  --  received byte
      TWI_THR  : Word with Atomic;  --  byte to transmit
   end record;

   for Peripheral use record
      TWI_CR   at 16#00# range 0 .. 31;
      TWI_MMR  at 16#04# range 0 .. 31;
      TWI_CWGR at 16#10# range 0 .. 31;
      TWI_SR   at 16#20# range 0 .. 31;
      TWI_IER  at 16#24# range 0 .. 31;
      TWI_IDR  at 16#28# range 0 .. 31;
      TWI_IMR  at 16#2C# range 0 .. 31;
      TWI_RHR  at 16#30# range 0 .. 31;
      TWI_THR  at 16#34# range 0 .. 31;
   end record;

   TWI : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFB_8000#);

   --  TWI_CR
   Start          : constant Word := Bit (0);  --  START
   Stop           : constant Word := Bit (1);  --  STOP
   Enable_Master  : constant Word := Bit (2);  --  MSEN
   Disable_Master : constant Word := Bit (3);  --  MSDIS
   Reset          : constant Word := Bit (7);  --  SWRST

   --  TWI_MMR
   Master_Reads : constant Word := Bit (12);  --  MREAD
   function To_Device (Address : Word) return Word is (Address * 2 ** 16)
     with Pre => Address < 128;

   --  TWI_SR and interrupts
   Transfer_Complete : constant Word := Bit (0);  --  TXCOMP
   Receive_Ready     : constant Word := Bit (1);  --  RXRDY
   Transmit_Ready    : constant Word := Bit (2);  --  TXRDY
   Overrun           : constant Word := Bit (6);  --  OVRE
   Not_Acknowledged  : constant Word := Bit (8);  --  NACK
   All_Interrupts    : constant Word :=
     Transfer_Complete or Receive_Ready or Transmit_Ready or Overrun or Not_Acknowledged;

   --  TWI_CWGR: each half period of SCL lasts divider + 3 cycles (datasheet,
   --  with CKDIV = 0): 48.05 MHz / (2 * 60) = 400.5 kHz
   Half_Period_Divider : constant := 57;
   Fast_Mode           : constant Word := Half_Period_Divider * 2 ** 8 + Half_Period_Divider;

end NXT.Registers.TWI;
