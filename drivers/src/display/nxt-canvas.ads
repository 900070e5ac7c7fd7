--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The picture that tasks write and draw on, and the place where the next letter goes. Each call is
--  one protected action.

with Interfaces;
with NXT.Fonts;
with NXT.LCD;

private package NXT.Canvas with Elaborate_Body is

   subtype Char_Columns is Fonts.Char_Columns;
   subtype Char_Rows    is LCD.Pixel_Rows;

   procedure Clear;
   --  Blank the picture and go to the upper left.

   procedure Move (Column : Char_Columns; Row : Char_Rows);
   --  Where the next letter goes.

   procedure New_Line;

   procedure Write (Text : String)
     with Pre => Text'Length <= Fonts.Text_Columns;

   procedure Write_At (Column : Char_Columns; Row : Char_Rows; Text : String);
   --  In one row, without moving; letters beyond the last column are cut off.

   type Pattern is record
      Keep : Interfaces.Unsigned_8;
      Flip : Interfaces.Unsigned_8;
   end record;
   --  What becomes of eight pixels: those in Keep stay, the others go; then those in Flip change.

   procedure Mix (Row : LCD.Pixel_Rows; Column : LCD.Pixel_Columns; How : Pattern);

   procedure Update;
   --  See NXT.LCD.Show.

end NXT.Canvas;
