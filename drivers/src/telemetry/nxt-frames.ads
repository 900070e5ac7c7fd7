--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Frames on a byte link that may lose or damage bytes: a content with a check value, coded so
--  that no byte is zero, and a zero at its end (docs/reference/telemetry.md). Nothing here waits
--  or allocates.

with Interfaces;  use Interfaces;
with NXT.Bytes;   use NXT.Bytes;

package NXT.Frames with Pure, SPARK_Mode is

   Longest_Content : constant := 120;
   Overhead        : constant := 4;
   --  Check value, first length, end; a content without zeros is below the length of a block.
   Longest_Frame   : constant := Longest_Content + Overhead;

   procedure Encode (Content : Byte_Array; Line : out Byte_Array; Last : out Natural) with
     Pre  => Content'Length in 1 .. Longest_Content
             and then Line'Length >= Content'Length + Overhead,
     Post => Last = Line'First + Content'Length + Overhead - 1;
   --  The bytes for the line in Line (Line'First .. Last).

   type Reader is private;
   --  What has arrived of a frame. Its initial value waits for the first byte.

   procedure Feed (This : in out Reader; Item : Byte; Complete : out Boolean);
   --  Take a byte of the line; Complete when it ended a frame with the right check value, whose
   --  content is there until the next call.

   function Content_Length (This : Reader) return Natural with
     Post => Content_Length'Result <= Longest_Content;

   function Content_Byte (This : Reader; Index : Positive) return Byte with
     Pre => Index <= Content_Length (This);

   function Content_Word (This : Reader; First : Positive) return Four_Bytes with
     Pre => First + 3 <= Content_Length (This);

   function Damaged (This : Reader) return Natural;
   --  Frames that were none.

private

   Check_Bytes : constant := 2;
   Check_Start : constant Unsigned_16 := 16#FFFF#;

   type Reader is record
      Data    : Byte_Array (1 .. Longest_Content + Check_Bytes) := (others => 0);
      Length  : Natural := 0;
      Left    : Natural := 0;
      Zero    : Boolean := False;
      Begun   : Boolean := False;
      Bad     : Boolean := False;
      Content : Natural := 0;
      Losses  : Natural := 0;
      Value   : Unsigned_16 := Check_Start;
   end record;
   --  Left: bytes until the next length. Zero: it stands for a zero. Content: of the last frame.
   --  Value: of all bytes but the last two, which may be the check's.

   function Content_Length (This : Reader) return Natural is (This.Content);

   function Content_Byte (This : Reader; Index : Positive) return Byte is (This.Data (Index));

   function Content_Word (This : Reader; First : Positive) return Four_Bytes is
     (This.Data (First .. First + 3));

   function Damaged (This : Reader) return Natural is (This.Losses);

end NXT.Frames;
