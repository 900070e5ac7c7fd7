--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Sending to the display: linked segments, fed by the DMA controller one after the other in
--  interrupts.

with Interfaces;
with System;

package NXT.SPI is

   subtype Byte is Interfaces.Unsigned_8;
   type Byte_Array is array (Natural range <>) of Byte;

   type Segment_Kind is (Command, Pixels);

   Maximum_Length : constant := 2 ** 16 - 1;
   subtype Segment_Length is Positive range 1 .. Maximum_Length;

   type Segment;
   type Segment_Access is access constant Segment;

   type Segment is record
      Length : Segment_Length;
      Kind   : Segment_Kind;
      Start  : System.Address;
      Next   : Segment_Access;
   end record;
   --  Length bytes from Start on, and what follows in the list. Segments and bytes must stay as
   --  they are until the list is through or withdrawn.

   for Segment use record
      Length at 0 range 0 .. 15;
      Kind   at 2 range 0 .. 7;
      Start  at 4 range 0 .. 31;
      Next   at 8 range 0 .. 31;
   end record;

   procedure Submit (List : not null Segment_Access);
   --  Send the segments from List on, after the list that is being sent. Returns at once. A list
   --  submitted before that has not begun is dropped. For one task at a time.

   procedure Withdraw (Withdrawn : out Boolean);
   --  Drop the list that was submitted last, unless it has begun.

   procedure Await_Idle;
   --  Wait until the last list is through. For one task at a time.

   procedure Send (Kind : Segment_Kind; Data : System.Address; Length : Segment_Length);
   --  Send one segment and wait until it is through.

   --  As known from GNAT for MINDSTORMS

   procedure Send (Is_Data : Boolean; Buf : System.Address; Len : Natural)
     with Pre => Len in Segment_Length;
   --  Send of Pixels or of a Command.

end NXT.SPI;
