--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  What the brick says of itself on the USB, and the requests that every device must know (USB 2.0
--  specification, chapter 9): one configuration with one interface of LEGO's own class, bulk
--  endpoint 1 from the host, bulk endpoint 2 to it.

with Interfaces;  use Interfaces;
with NXT.Bytes;   use NXT.Bytes;

private package NXT.USB_Descriptors with SPARK_Mode is

   Control_Packet : constant := 8;
   Longest_Reply  : constant := 32;
   subtype Control_Data is Byte_Array (1 .. Longest_Reply);

   --  Requests

   subtype Request is Byte_Array (1 .. 8);
   Value_Low : constant := 3;

   type Request_Kind is
     (Get_Device, Get_Configuration_Descriptor, Get_Languages, Get_Serial, Set_Address,
      Set_Configuration, Get_Configuration, Get_Status, Accepted, Unknown);
   --  Accepted: has no effect on this device.

   function Kind_Of (Item : Request) return Request_Kind;

   function Is_To_Host (Item : Request) return Boolean is ((Item (1) and 16#80#) /= 0);

   function Requested_Length (Item : Request) return Natural is
     (Natural (Item (7)) + 256 * Natural (Item (8)));
   --  The most bytes that the host takes.

   --  Descriptors

   Vendor_Low   : constant Byte := 16#94#;
   Vendor_High  : constant Byte := 16#06#;
   Product_Low  : constant Byte := 16#02#;
   Product_High : constant Byte := 16#00#;
   Own_Class    : constant Byte := 16#FF#;
   Serial_Index : constant Byte := 1;

   Nothing : constant Byte_Array (1 .. 0) := (others => 0);

   Device_Descriptor : constant Byte_Array (1 .. 18) :=
     (18, 1, 16#00#, 16#02#, 0, 0, 0, Control_Packet, Vendor_Low, Vendor_High, Product_Low,
      Product_High, 0, 0, 0, 0, Serial_Index, 1);
   --  USB 2.0, no class of the device, device release 0.0, one configuration

   Configuration_Descriptor : constant Byte_Array (1 .. 32) :=
     (9, 2, 32, 0, 1, 1, 0, 16#C0#, 0,
      9, 4, 0, 0, 2, Own_Class, Own_Class, Own_Class, 0,
      7, 5, 16#01#, 2, 64, 0, 0,
      7, 5, 16#82#, 2, 64, 0, 0);
   --  Configuration 1, powered by its own battery; interface 0; two bulk endpoints of 64 bytes

   Languages : constant Byte_Array (1 .. 4) := (4, 3, 16#09#, 16#04#);
   --  English of the United States

   Self_Powered_Status : constant Byte_Array (1 .. 2) := (1, 0);

   function Text_Descriptor (Text : String) return Byte_Array with
     Pre  => 2 + 2 * Text'Length <= Longest_Reply,
     Post => Text_Descriptor'Result'Length = 2 + 2 * Text'Length;
   --  In UTF-16.

end NXT.USB_Descriptors;
