--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Glyphs anywhere on the display, as known from GNAT for MINDSTORMS. NXT.Display.Drawing has more.

with NXT.LCD;  use NXT.LCD;

package NXT.Graph is

   Glyph_Height : constant := 8;

   subtype Graph_Columns is Natural range 0 .. 99;
   subtype Graph_Rows    is Natural range 0 .. 63;

   procedure Clear;
   --  Blank the display.

   procedure Draw_Glyph (X : Graph_Columns; Y : Graph_Rows; Glyph : LCD_Line);
   --  Invert the pixels of Glyph from (X, Y) on: drawn twice it is gone. What is beyond the edges
   --  is cut off. The display follows at once.

end NXT.Graph;
