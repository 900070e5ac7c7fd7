--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The serial line to the Bluetooth module: bytes come and go by DMA in the background, and the
--  handshake holds the module back while there is no room. No call waits. For one task at a time.

with NXT.Bytes;  use NXT.Bytes;

package NXT.Bluetooth_Line is

   procedure Power_Off;
   --  The module is held in reset.

   procedure Power_On;
   --  The module starts; it says so within half a second or so.

   procedure Request_Stream (On : Boolean);
   --  Ask for the stream of the connection that was opened, or for messages.

   procedure Read_Mode (Is_Stream : out Boolean);
   --  Whether the module is in stream mode, as it was at the call before: each call begins a
   --  conversion and gives the result of the last one.

   Send_Capacity : constant := 512;

   function Room return Natural with
     Post => Room'Result < Send_Capacity;
   --  Bytes that Send takes.

   procedure Send (Data : Byte_Array) with
     Pre => Data'Length <= Room;

   function All_Sent return Boolean;
   --  Nothing waits, and the last bit has left.

   procedure Receive (Data : out Byte_Array; Last : out Natural) with
     Pre => Data'Length > 0;
   --  What has come, at most Data'Length bytes, in Data (Data'First .. Last).

   procedure Receive (Item : out Byte; Found : out Boolean);
   --  The next byte that has come, if there is one.

   procedure Discard_Unsent;
   --  Throw away what has not been sent; two bytes may still be on their way.

end NXT.Bluetooth_Line;
