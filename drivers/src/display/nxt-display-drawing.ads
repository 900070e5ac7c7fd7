--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Pixels, lines, rectangles and bitmaps on the display, on the same picture as the text. Nothing
--  here waits for the display; Screen_Update shows what was drawn. Any number of tasks may draw.

package NXT.Display.Drawing is

   type X_Position is range 0 .. 99;
   type Y_Position is range 0 .. 63;

   type Point is record
      X : X_Position;
      Y : Y_Position;
   end record;
   --  Counted from the upper left.

   type Ink is (Dark, Clear, Inverse);

   procedure Draw_Pixel (At_Point : Point; Colour : Ink := Dark);

   procedure Draw_Line (From, To : Point; Colour : Ink := Dark);
   --  Both ends included (Bresenham 1965).

   procedure Draw_Rectangle (Corner, Opposite : Point; Colour : Ink := Dark);
   --  Its four sides; each pixel is drawn once.

   procedure Fill_Rectangle (Corner, Opposite : Point; Colour : Ink := Dark);

   subtype Bitmap_Column is Interfaces.Unsigned_8;
   type Bitmap is array (Positive range <>) of Bitmap_Column;
   --  Eight lines high, from left to right; the lowest bit of a column is the top.

   procedure Draw_Bitmap (Upper_Left : Point; Image : Bitmap; Colour : Ink := Dark);
   --  Pixels of Image that are set are drawn, others stay. What is beyond the right or lower edge
   --  is cut off. Higher pictures are several.

end NXT.Display.Drawing;
