--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Two-wire interface (datasheet, chapter TWI), used as the bus master towards the co-processor.

with System;

package NXT.Registers.TWI is

   type Peripheral is record
      Control           : Word with Atomic;
      Master_Mode       : Word with Atomic;
      Internal_Address  : Word with Atomic;
      Clock_Waveform    : Word with Atomic;
      Status            : Word with Atomic;
      Enable_Interrupt  : Word with Atomic;
      Disable_Interrupt : Word with Atomic;
      Interrupt_Mask    : Word with Atomic;
      Receive           : Word with Atomic;
      Transmit          : Word with Atomic;
   end record;

   for Peripheral use record
      Control           at 16#00# range 0 .. 31;
      Master_Mode       at 16#04# range 0 .. 31;
      Internal_Address  at 16#0C# range 0 .. 31;
      Clock_Waveform    at 16#10# range 0 .. 31;
      Status            at 16#20# range 0 .. 31;
      Enable_Interrupt  at 16#24# range 0 .. 31;
      Disable_Interrupt at 16#28# range 0 .. 31;
      Interrupt_Mask    at 16#2C# range 0 .. 31;
      Receive           at 16#30# range 0 .. 31;
      Transmit          at 16#34# range 0 .. 31;
   end record;

   TWI : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFB_8000#);

   --  Control
   Start          : constant Word := Bit (0);
   Stop           : constant Word := Bit (1);
   Enable_Master  : constant Word := Bit (2);
   Disable_Master : constant Word := Bit (3);
   Reset          : constant Word := Bit (7);

   --  Master_Mode
   Master_Reads : constant Word := Bit (12);
   function To_Device (Address : Word) return Word is (Address * 2 ** 16)
     with Pre => Address < 128;

   --  Status and interrupts
   Transfer_Complete : constant Word := Bit (0);
   Receive_Ready     : constant Word := Bit (1);
   Transmit_Ready    : constant Word := Bit (2);
   Overrun           : constant Word := Bit (6);
   Not_Acknowledged  : constant Word := Bit (8);
   All_Interrupts    : constant Word :=
     Transfer_Complete or Receive_Ready or Transmit_Ready or Overrun or Not_Acknowledged;

   --  Clock_Waveform: each half period of SCL lasts divider + 3 cycles (datasheet, TWI_CWGR with
   --  CKDIV = 0): 48.05 MHz / (2 * 60) = 400.5 kHz
   Half_Period_Divider : constant := 57;
   Fast_Mode           : constant Word := Half_Period_Divider * 2 ** 8 + Half_Period_Divider;

end NXT.Registers.TWI;
