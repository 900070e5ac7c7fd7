--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Sending to the display: lists of segments, fed by the DMA controller and chained by interrupts.

with Interfaces;
with System;

package NXT.SPI is

   subtype Byte is Interfaces.Unsigned_8;
   type Byte_Array is array (Natural range <>) of Byte;

   type Segment_Kind is (Command, Pixels);

   Maximum_Length : constant := 2 ** 16 - 1;
   subtype Segment_Length is Positive range 1 .. Maximum_Length;

   type Segment is record
      Kind   : Segment_Kind;
      Start  : System.Address;
      Length : Segment_Length;
   end record;
   --  Length bytes from Start on. They must stay as they are until the list is through.

   Maximum_Segments : constant := 16;
   type Segment_List is array (Positive range <>) of Segment;

   procedure Submit (List : Segment_List)
     with Pre => List'Length in 1 .. Maximum_Segments;
   --  Send the segments in their order, after the list that is being sent. Returns at once. A list
   --  submitted before that has not begun is dropped. For one task at a time.

   procedure Withdraw (Withdrawn : out Boolean);
   --  Drop the list that was submitted last, unless it has begun.

   procedure Start (List : Segment_List)
     with Pre => List'Length in 1 .. Maximum_Segments;
   --  Send the segments in their order; wait for the lists before, not for this one. For one task
   --  at a time.

   procedure Await_Idle;
   --  Wait until the last list is through. For one task at a time.

   procedure Send (Kind : Segment_Kind; Data : System.Address; Length : Segment_Length);
   --  Send one segment and wait until it is through.

   --  As known from GNAT for MINDSTORMS

   procedure Send (Is_Data : Boolean; Buf : System.Address; Len : Natural)
     with Pre => Len in Segment_Length;
   --  Send of Pixels or of a Command.

end NXT.SPI;
