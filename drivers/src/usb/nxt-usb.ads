--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The brick as a USB device with LEGO's identity (0694:0002): a packet of at most 64 bytes from
--  the host is one element, and so is each packet to the host. Interrupts move them between the
--  port and two short queues; the host waits while one is full. No call waits. For one task at a
--  time in each direction.

with NXT.Bytes;

package NXT.USB is

   Packet_Size  : constant := 64;
   Queue_Length : constant := 4;

   subtype Packet_Length is Natural range 0 .. Packet_Size;
   subtype Packet_Data is Bytes.Byte_Array (1 .. Packet_Size);

   subtype Serial_Text is String (1 .. 12);

   procedure Attach (Serial : Serial_Text := "001653000000");
   --  Appear on the bus, if a cable is there. Hosts tell bricks apart by Serial, twelve
   --  hexadecimal digits: LEGO uses the Bluetooth address.

   procedure Detach;
   --  Disappear from the bus.

   function Configured return Boolean;
   --  A host has found the brick and uses it.

   function Packets_Free return Natural with
     Post => Packets_Free'Result <= Queue_Length;
   --  How many packets Send takes now: none while no host is there.

   procedure Send (Data : Bytes.Byte_Array) with
     Pre => Data'Length in 1 .. Packet_Size and then Packets_Free > 0;

   procedure Receive (Data : out Packet_Data; Length : out Packet_Length);
   --  The next packet of the host; Length 0 when there is none.

end NXT.USB;
