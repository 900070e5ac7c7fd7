--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.Registers.PIO;  use NXT.Registers, NXT.Registers.PIO;
with NXT.Registers.PMC;
with NXT.Registers.TWI;

package body NXT.TWI.Bus is

   use type Word;

   Controller : Registers.TWI.Peripheral renames Registers.TWI.TWI;

   Data  : constant Word := Bit (TWI_Data);
   Clock : constant Word := Bit (TWI_Clock);

   --  Reads of the pins that last at least half a period of a 400 kHz clock, 60 cycles.
   Half_Period_Reads : constant := 20;

   --  A device that is stopped in the middle of a byte lets the data line go after at most eight
   --  bits and its acknowledge (NXP UM10204, section 3.1.16, bus clear). One that does not is met
   --  again by the next reset.
   Clearing_Clocks : constant := 9;

   --  Polls before a silent interface is given up: far more than a byte at 400 kHz lasts.
   Patience : constant := 20_000;

   procedure Wait_Half_Period is
      Levels : Word;
   begin
      for Read in 1 .. Half_Period_Reads loop
         Levels := PIOA.PIO_PDSR;
      end loop;
      pragma Unreferenced (Levels);
   end Wait_Half_Period;

   procedure Pulse_Clock is
   begin
      PIOA.PIO_CODR := Clock;
      Wait_Half_Period;
      PIOA.PIO_SODR := Clock;
      Wait_Half_Period;
   end Pulse_Clock;

   procedure Send_Stop_Condition is
   begin
      PIOA.PIO_CODR := Clock;
      Wait_Half_Period;
      PIOA.PIO_CODR := Data;
      Wait_Half_Period;
      PIOA.PIO_SODR := Clock;
      Wait_Half_Period;
      PIOA.PIO_SODR := Data;
      Wait_Half_Period;
   end Send_Stop_Condition;

   procedure Free_Bus is
   begin
      PIOA.PIO_MDER := Data or Clock;
      PIOA.PIO_PUDR := Data or Clock;
      PIOA.PIO_SODR := Data or Clock;
      PIOA.PIO_OER := Data or Clock;
      PIOA.PIO_PER := Data or Clock;
      for Count in 1 .. Clearing_Clocks loop
         Pulse_Clock;
      end loop;
      Send_Stop_Condition;
   end Free_Bus;

   procedure Reset is
      use NXT.Registers.TWI;
   begin
      PMC.PMC.PMC_PCER := Bit (PIOA_Id) or Bit (TWI_Id);
      Controller.TWI_IDR := All_Interrupts;
      Controller.TWI_CR := Disable_Master;
      Free_Bus;
      Controller.TWI_CR := Registers.TWI.Reset;
      PIOA.PIO_ASR := Data or Clock;
      PIOA.PIO_PDR := Data or Clock;
      Controller.TWI_CWGR := Fast_Mode;
      Controller.TWI_CR := Enable_Master;
   end Reset;

   --  Wait until one of Flags is up; what was up is in Seen, nothing when patience ended. A status
   --  that is read while a stop condition is on the bus loses Not_Acknowledged (erratum of the
   --  chip): a transfer that is complete too early was refused as well.
   procedure Await (Flags : Word; Seen : out Word) is
   begin
      for Poll in 1 .. Patience loop
         Seen := Controller.TWI_SR and Flags;
         exit when Seen /= 0;
      end loop;
   end Await;

   procedure Send_Polled (Device : Device_Id; Message : Byte_Array; Acknowledged : out Boolean) is
      use NXT.Registers.TWI;
      Seen : Word := Transmit_Ready;
   begin
      Controller.TWI_MMR := To_Device (Word (Device));
      for Value of Message loop
         Controller.TWI_THR := Word (Value);
         Await (Transmit_Ready or Transfer_Complete or Not_Acknowledged, Seen);
         exit when Seen /= Transmit_Ready;
      end loop;
      Acknowledged := Seen = Transmit_Ready;
      if Acknowledged then
         Await (Transfer_Complete or Not_Acknowledged, Seen);
         Acknowledged := Seen = Transfer_Complete;
      end if;
   end Send_Polled;

   --  The stop must be asked for while the last byte is on its way (datasheet, chapter TWI, master
   --  receiver).
   procedure Receive_Polled (Device : Device_Id; Message : out Byte_Array; Complete : out Boolean)
   is
      use NXT.Registers.TWI;
      Seen : Word;
   begin
      Message := (others => 0);
      Controller.TWI_MMR := To_Device (Word (Device)) or Master_Reads;
      Controller.TWI_CR := Registers.TWI.Start;
      for Place in Message'Range loop
         Await (Receive_Ready or Transfer_Complete or Not_Acknowledged, Seen);
         exit when not Has (Seen, Receive_Ready);
         Message (Place) := Byte (Controller.TWI_RHR and 16#FF#);
         if Place = Message'Last - 1 then
            Controller.TWI_CR := Stop;
         end if;
      end loop;
      Complete := Has (Seen, Receive_Ready);
      if Complete then
         Await (Transfer_Complete, Seen);
         Complete := Seen = Transfer_Complete;
      end if;
   end Receive_Polled;

end NXT.TWI.Bus;
