--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The RS485 line of sensor port 4 (NXT Hardware Developer Kit, high-speed communication): bytes of
--  eight bits without parity at 921,600 bit/s between two or more bricks or devices. One at a time
--  may send; who, is the program's business. Both directions go by DMA: an interrupt comes every
--  64 bytes received and at the end of what is sent, and nothing waits but Await_Sent.

with Interfaces;

package NXT.RS485 with Elaborate_Body is

   subtype Byte is Interfaces.Unsigned_8;
   type Byte_Array is array (Positive range <>) of Byte;

   type Bits_Per_Second is range 9_600 .. 921_600;

   type Connection is (Line, Loop_Back);
   --  Loop_Back: what is sent is received, and does not leave the processor. For tests.

   procedure Open (Rate : Bits_Per_Second := 921_600; To : Connection := Line);
   --  Take the pins of port 4; nothing else may use that port.

   procedure Close;

   Longest_Message : constant := 128;

   procedure Send (Message : Byte_Array; Accepted : out Boolean)
     with Pre => Message'Length in 1 .. Longest_Message;
   --  Copy Message and begin to send it. Not Accepted while another is being sent or the line is
   --  not open.

   function Sending return Boolean;

   procedure Await_Sent;
   --  Suspend the caller until the last bit of what was accepted is out. By one task at a time.

   procedure Receive (Data : out Byte_Array; Count : out Natural);
   --  Take the first bytes that have come, Count of them, at most Data'Length; the others of Data
   --  are zero. 128 bytes are kept at least; what comes beyond is lost, see Lost_Bytes.

   function Lost_Bytes return Boolean;
   --  Whether bytes were lost or damaged since the line was opened.

end NXT.RS485;
