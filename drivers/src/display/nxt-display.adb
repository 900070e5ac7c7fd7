--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.Canvas;
with NXT.Fonts;

package body NXT.Display is

   use Interfaces;

   procedure Clear_Screen_Noupdate is
   begin
      Canvas.Clear;
   end Clear_Screen_Noupdate;

   procedure Set_Pos (Column : Char_Columns; Row : Char_Rows) is
   begin
      Canvas.Move (Column, Row);
   end Set_Pos;

   procedure Newline_Noupdate is
   begin
      Canvas.New_Line;
   end Newline_Noupdate;

   procedure Put_Noupdate (C : Character) is
   begin
      Canvas.Write ((1 => C));
   end Put_Noupdate;

   procedure Put_Noupdate (S : String) is
      Piece : constant := Fonts.Text_Columns;
      First : Integer := S'First;
   begin
      while S'Last - First >= Piece loop
         pragma Annotate (Ravenbrick, Iterations, 7, "a text fills the eight rows at most");
         Canvas.Write (S (First .. First + Piece - 1));
         First := First + Piece;
      end loop;
      Canvas.Write (S (First .. S'Last));
   end Put_Noupdate;

   procedure Put_At_Noupdate (Column : Char_Columns; Row : Char_Rows; S : String) is
   begin
      Canvas.Write_At (Column, Row, S);
   end Put_At_Noupdate;

   procedure Put_At (Column : Char_Columns; Row : Char_Rows; S : String) is
   begin
      Canvas.Write_At (Column, Row, S);
      Screen_Update;
   end Put_At;

   generic
      type Number is range <>;
   procedure Put_Number (V : Number; Width : Field_Width);

   --  Works on negative numbers, whose range is the larger one.
   procedure Put_Number (V : Number; Width : Field_Width) is
      Image : String (1 .. 20) := (others => ' ');
      First : Positive := Image'Last + 1;
      Rest  : Number := (if V < 0 then V else -V);
   begin
      loop
         pragma Annotate (Ravenbrick, Iterations, 19, "digits of the larger type");
         First := First - 1;
         Image (First) := Character'Val (Character'Pos ('0') - Integer (Rest rem 10));
         Rest := Rest / 10;
         exit when Rest = 0;
      end loop;
      if V < 0 then
         First := First - 1;
         Image (First) := '-';
      end if;
      First := Integer'Min (First, Image'Last + 1 - Width);
      if Image'Last - First >= Fonts.Text_Columns then
         Canvas.Write (Image (First .. First + Fonts.Text_Columns - 1));
         First := First + Fonts.Text_Columns;
      end if;
      Canvas.Write (Image (First .. Image'Last));
   end Put_Number;

   procedure Put_Integer is new Put_Number (Integer);
   procedure Put_Long_Long_Integer is new Put_Number (Long_Long_Integer);

   procedure Put_Noupdate (V : Integer; Width : Field_Width := 0) renames Put_Integer;

   procedure Put_Noupdate (V : Long_Long_Integer; Width : Field_Width := 0)
     renames Put_Long_Long_Integer;

   subtype Digit_Count is Positive range 1 .. 8;

   procedure Put_Hex (Val : Unsigned_32; Digit_Number : Digit_Count) is
      Hex_Digits : constant String (1 .. 16) := "0123456789ABCDEF";
      Image      : String (1 .. Digit_Number);
   begin
      for Place in Image'Range loop
         pragma Annotate (Ravenbrick, Iterations, 8, "digits of 32 bits");
         Image (Place) :=
           Hex_Digits (1 + Natural (Shift_Right (Val, 4 * (Digit_Number - Place)) and 16#F#));
      end loop;
      Put_Noupdate (Image);
   end Put_Hex;

   procedure Put_Hex (Val : Unsigned_32) is
   begin
      Put_Hex (Val, 8);
   end Put_Hex;

   procedure Put_Hex (Val : Unsigned_16) is
   begin
      Put_Hex (Unsigned_32 (Val), 4);
   end Put_Hex;

   procedure Put_Hex (Val : Unsigned_8) is
   begin
      Put_Hex (Unsigned_32 (Val), 2);
   end Put_Hex;

   procedure Screen_Update is
   begin
      Canvas.Update;
   end Screen_Update;

   procedure Clear_Screen is
   begin
      Clear_Screen_Noupdate;
      Screen_Update;
   end Clear_Screen;

   procedure Put (C : Character) is
   begin
      Put_Noupdate (C);
      Screen_Update;
   end Put;

   procedure Put (S : String) is
   begin
      Put_Noupdate (S);
      Screen_Update;
   end Put;

   procedure Put (V : Integer; Width : Field_Width := 0) is
   begin
      Put_Noupdate (V, Width);
      Screen_Update;
   end Put;

   procedure Put_Line (S : String) is
   begin
      Put_Noupdate (S);
      Newline;
   end Put_Line;

   procedure Newline is
   begin
      Newline_Noupdate;
      Screen_Update;
   end Newline;

   procedure Put_Exception (Addr : Unsigned_32) is
   begin
      Put_Noupdate ("error at");
      Put_Hex (Addr);
      Screen_Update;
   end Put_Exception;

end NXT.Display;
