--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts.Names;
with Ada.Real_Time;
with NXT.Priorities;
with NXT.Registers.TWI;  use NXT.Registers, NXT.Registers.TWI;
with NXT.TWI.Bus;

package body NXT.TWI is

   use type Word;

   Controller : Registers.TWI.Peripheral renames Registers.TWI.TWI;

   protected Transfer with Interrupt_Priority => Priorities.TWI_Interrupt is
      function Status return Transfer_Status;
      procedure Send (Device : Device_Id; Message : Byte_Array);
      procedure Receive (Device : Device_Id; Count : Transfer_Length);
      procedure Fetch (Message : out Byte_Array);
      procedure Abandon;
   private
      procedure Handle_Interrupt with Attach_Handler => Ada.Interrupts.Names.TWI;
      procedure Handle_Received_Byte;
      procedure Handle_Free_Transmitter;
      procedure Await_End_On_Bus;
      procedure Finish (Result : Transfer_Status);

      State  : Transfer_Status := Done;
      Buffer : Byte_Array (1 .. Maximum_Length) := (others => 0);
      Length : Natural := 0;
      Next   : Positive := 1;
   end Transfer;

   protected body Transfer is

      function Status return Transfer_Status is (State);

      procedure Send (Device : Device_Id; Message : Byte_Array) is
      begin
         if Message'Length = 0 then
            State := Done;
            return;
         end if;
         State := Busy;
         Length := Message'Length;
         Buffer (1 .. Length) := Message;
         Next := 2;
         Controller.TWI_MMR := To_Device (Word (Device));
         Controller.TWI_THR := Word (Buffer (1));
         Controller.TWI_IER := Transmit_Ready or Not_Acknowledged;
      end Send;

      procedure Receive (Device : Device_Id; Count : Transfer_Length) is
      begin
         State := Busy;
         Length := Count;
         Next := 1;
         Controller.TWI_MMR := To_Device (Word (Device)) or Master_Reads;
         Controller.TWI_CR := Start;
         Controller.TWI_IER := Receive_Ready or Overrun or Not_Acknowledged;
      end Receive;

      procedure Fetch (Message : out Byte_Array) is
      begin
         Message := Buffer (1 .. Message'Length);
      end Fetch;

      procedure Abandon is
      begin
         Finish (Failed);
      end Abandon;

      procedure Finish (Result : Transfer_Status) is
      begin
         Controller.TWI_IDR := All_Interrupts;
         State := Result;
      end Finish;

      --  The bytes are through, the stop condition is not: only then is the bus free again.
      procedure Await_End_On_Bus is
      begin
         Controller.TWI_IDR := All_Interrupts;
         Controller.TWI_IER := Transfer_Complete or Not_Acknowledged;
      end Await_End_On_Bus;

      --  The stop must be asked for while the last byte is on its way, that is after the last but
      --  one was taken (datasheet, chapter TWI, master receiver).
      procedure Handle_Received_Byte is
      begin
         Buffer (Next) := Byte (Controller.TWI_RHR and 16#FF#);
         Next := Next + 1;
         if Next = Length then
            Controller.TWI_CR := Stop;
         elsif Next > Length then
            Await_End_On_Bus;
         end if;
      end Handle_Received_Byte;

      --  When nothing follows in time the interface sends the stop by itself (datasheet, chapter
      --  TWI, master transmitter).
      procedure Handle_Free_Transmitter is
      begin
         if Next <= Length then
            Controller.TWI_THR := Word (Buffer (Next));
            Next := Next + 1;
         else
            Await_End_On_Bus;
         end if;
      end Handle_Free_Transmitter;

      procedure Handle_Interrupt is
         Mask : constant Word := Controller.TWI_IMR;
         Flags : constant Word := Controller.TWI_SR and Mask;
      begin
         if Has (Flags, Not_Acknowledged or Overrun) then
            Finish (Failed);
         elsif Has (Flags, Receive_Ready) then
            Handle_Received_Byte;
         elsif Has (Flags, Transmit_Ready) then
            Handle_Free_Transmitter;
         elsif Has (Flags, Transfer_Complete) then
            Finish (Done);
         end if;
      end Handle_Interrupt;

   end Transfer;

   function Status return Transfer_Status is (Transfer.Status);

   procedure Start_Send (Device : Device_Id; Message : Byte_Array) is
   begin
      Transfer.Send (Device, Message);
   end Start_Send;

   procedure Start_Receive (Device : Device_Id; Length : Transfer_Length) is
   begin
      Transfer.Receive (Device, Length);
   end Start_Receive;

   procedure Fetch (Message : out Byte_Array) is
   begin
      Transfer.Fetch (Message);
   end Fetch;

   Set_Up : Boolean := False with Atomic;

   procedure Reset is
   begin
      Transfer.Abandon;
      Bus.Reset;
      Set_Up := True;
   end Reset;

   procedure Set_Up_Once is
   begin
      if not Set_Up then
         Reset;
      end if;
   end Set_Up_Once;

   procedure Await_End is
      use Ada.Real_Time;
      Poll_Time : constant Time_Span := Microseconds (500);
      Polls     : constant := 20;
      Next_Poll : Time := Clock;
   begin
      for Poll in 1 .. Polls loop
         exit when Status /= Busy;
         Next_Poll := Next_Poll + Poll_Time;
         delay until Next_Poll;
      end loop;
      if Status = Busy then
         Reset;
      end if;
   end Await_End;

   procedure Send
     (Dev : Device_Id; Adrlen : Address_Length; Msg : System.Address; Msg_Len : Natural)
   is
      pragma Unreferenced (Adrlen);
      Message : Byte_Array (1 .. Msg_Len) with Import, Address => Msg;
   begin
      Set_Up_Once;
      Start_Send (Dev, Message);
      Await_End;
   end Send;

   procedure Recv
     (Dev : Device_Id; Adrlen : Address_Length; Msg : System.Address; Msg_Len : Natural)
   is
      pragma Unreferenced (Adrlen);
      Message : Byte_Array (1 .. Msg_Len) with Import, Address => Msg;
   begin
      Set_Up_Once;
      Start_Receive (Dev, Msg_Len);
      Await_End;
      if Status = Done then
         Fetch (Message);
      else
         Message := (others => 0);
      end if;
   end Recv;

end NXT.TWI;
