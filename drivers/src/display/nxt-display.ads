--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Text on the display: 16 columns of 8 rows, as on a terminal that scrolls. Column 0 of row 0 is
--  the upper left. Procedures whose name ends in _Noupdate, and Put_Hex, write into memory only;
--  the others end with Screen_Update. Nothing here waits for the display. Any number of tasks may
--  use the package; pieces of 16 letters, and shorter texts and numbers, stay together. Tasks
--  that write at places of their own use Put_At.

with Interfaces;

package NXT.Display with Elaborate_Body is

   subtype Char_Columns is Natural range 0 .. 15;
   subtype Char_Rows    is Natural range 0 .. 7;

   procedure Clear_Screen_Noupdate;
   procedure Clear_Screen;
   --  Blank the screen and go to the upper left.

   procedure Set_Pos (Column : Char_Columns; Row : Char_Rows);
   --  Where the next character goes.

   subtype Field_Width is Natural range 0 .. 16;

   procedure Put_Noupdate (C : Character);
   procedure Put_Noupdate (S : String);
   procedure Put_Noupdate (V : Integer; Width : Field_Width := 0);
   procedure Put_Noupdate (V : Long_Long_Integer; Width : Field_Width := 0);
   --  Line feed and carriage return move as on a terminal, other control characters show as
   --  blanks. Text beyond the last column goes on in the next row. Numbers are decimal, on the
   --  right of Width columns, or as wide as they need to be. The timing analysis takes a text to
   --  have at most the 128 letters of a full display.

   procedure Put (C : Character);
   procedure Put (S : String);
   procedure Put (V : Integer; Width : Field_Width := 0);
   procedure Put_Line (S : String);

   procedure Put_At_Noupdate (Column : Char_Columns; Row : Char_Rows; S : String);
   procedure Put_At (Column : Char_Columns; Row : Char_Rows; S : String);
   --  Recommended: write in one row from a place on, and leave the place of the next character to
   --  others. Text beyond the last column is cut off; control characters show as blanks.

   procedure Newline_Noupdate;
   procedure Newline;
   procedure New_Line_Noupdate renames Newline_Noupdate;
   procedure New_Line renames Newline;
   --  Go to the beginning of the next row; on the last row, scroll.

   procedure Put_Hex (Val : Interfaces.Unsigned_32);
   procedure Put_Hex (Val : Interfaces.Unsigned_16);
   procedure Put_Hex (Val : Interfaces.Unsigned_8);
   --  With leading zeros.

   procedure Put_Exception (Addr : Interfaces.Unsigned_32);
   --  An address with a word that says what it is.

   procedure Screen_Update;
   --  Let the display follow what is in memory: see NXT.LCD.Show.

end NXT.Display;
