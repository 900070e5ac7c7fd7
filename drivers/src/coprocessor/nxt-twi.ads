--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Transfers on the two-wire bus, driven by interrupts. A transfer is started and looked at later;
--  no caller waits, so a silent device cannot stop a task.

with Interfaces;
with System;

package NXT.TWI is

   subtype Byte is Interfaces.Unsigned_8;
   type Byte_Array is array (Positive range <>) of Byte;

   Maximum_Length : constant := 48;
   subtype Transfer_Length is Positive range 1 .. Maximum_Length;

   subtype Device_Id is Natural range 0 .. 127;
   --  Bus address without the direction bit.

   type Transfer_Status is (Done, Busy, Failed);
   --  Failed: not acknowledged, or a received byte was lost.

   function Status return Transfer_Status;
   --  The state of the last transfer started; Done before the first one.

   procedure Start_Send (Device : Device_Id; Message : Byte_Array)
     with Pre => Message'Length <= Maximum_Length;
   --  Send a copy of Message. The previous transfer must have ended, see Status. The interface
   --  cannot send an address alone: an empty message is Done without a transfer.

   procedure Start_Receive (Device : Device_Id; Length : Transfer_Length)
     with Pre => Length >= 2;
   --  Ask for Length bytes. The previous transfer must have ended, see Status.

   procedure Fetch (Message : out Byte_Array)
     with Pre => Message'Length in Transfer_Length;
   --  The first bytes of the buffer that the last transfer used.

   procedure Reset;
   --  Give up a transfer, free the bus of a device that holds it, and set the interface up anew.

   --  As known from GNAT for MINDSTORMS, for programs that do without NXT.AVR. The caller is
   --  delayed until the transfer has ended; one that lasts more than 10 ms is given up, with a
   --  reset. The first call sets the interface up.

   subtype Address_Length is Natural range 0 .. 3;

   procedure Send
     (Dev : Device_Id; Adrlen : Address_Length; Msg : System.Address; Msg_Len : Natural)
     with Pre => Adrlen = 0 and then Msg_Len <= Maximum_Length;

   procedure Recv
     (Dev : Device_Id; Adrlen : Address_Length; Msg : System.Address; Msg_Len : Natural)
     with Pre => Adrlen = 0 and then Msg_Len in 2 .. Maximum_Length;
   --  The co-processor has no addresses within, hence no Adrlen. What fails reads as zeros.

end NXT.TWI;
