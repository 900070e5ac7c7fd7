--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.Fonts;
with NXT.LCD;

package body NXT.Display is

   use Interfaces;
   use NXT.LCD;

   Canvas : Picture;
   Column : Natural range 0 .. Char_Columns'Last + 1 := 0;
   Row    : Char_Rows := 0;
   --  Column one beyond the last: the next character begins a new row.

   procedure Clear_Screen_Noupdate is
   begin
      Canvas := (others => (others => 0));
      Set_Pos (0, 0);
   end Clear_Screen_Noupdate;

   procedure Set_Pos (Column : Char_Columns; Row : Char_Rows) is
   begin
      Display.Column := Column;
      Display.Row := Row;
   end Set_Pos;

   procedure Newline_Noupdate is
   begin
      Column := 0;
      if Row < Char_Rows'Last then
         Row := Row + 1;
      else
         for Page in Raw_Pages'First .. Raw_Pages'Last - 1 loop
            Canvas (Page) := Canvas (Page + 1);
         end loop;
         Canvas (Raw_Pages'Last) := (others => 0);
      end if;
   end Newline_Noupdate;

   procedure Draw (C : Character) is
      Left  : constant Raw_Columns := Raw_Columns (Fonts.Left_Edge (Column));
      Shape : constant Fonts.Glyph := Fonts.Shape_Of (C);
   begin
      for Part in Shape'Range loop
         Canvas (Raw_Pages (Row)) (Left + Raw_Columns (Part)) := Shape (Part);
      end loop;
   end Draw;

   procedure Put_Noupdate (C : Character) is
   begin
      if C = ASCII.CR then
         Column := 0;
      elsif C = ASCII.LF then
         Newline_Noupdate;
      else
         if Column > Char_Columns'Last then
            Newline_Noupdate;
         end if;
         Draw (C);
         Column := Column + 1;
      end if;
   end Put_Noupdate;

   procedure Put_Noupdate (S : String) is
   begin
      for C of S loop
         Put_Noupdate (C);
      end loop;
   end Put_Noupdate;

   generic
      type Number is range <>;
   procedure Put_Number (V : Number; Width : Field_Width);

   --  Works on negative numbers, whose range is the larger one.
   procedure Put_Number (V : Number; Width : Field_Width) is
      Image : String (1 .. 20);
      First : Natural := Image'Last + 1;
      Rest  : Number := (if V < 0 then V else -V);
   begin
      loop
         First := First - 1;
         Image (First) := Character'Val (Character'Pos ('0') - Integer (Rest rem 10));
         Rest := Rest / 10;
         exit when Rest = 0;
      end loop;
      if V < 0 then
         First := First - 1;
         Image (First) := '-';
      end if;
      for Blank in Image'Last - First + 2 .. Width loop
         Put_Noupdate (' ');
      end loop;
      Put_Noupdate (Image (First .. Image'Last));
   end Put_Number;

   procedure Put_Integer is new Put_Number (Integer);
   procedure Put_Long_Long_Integer is new Put_Number (Long_Long_Integer);

   procedure Put_Noupdate (V : Integer; Width : Field_Width := 0) renames Put_Integer;

   procedure Put_Noupdate (V : Long_Long_Integer; Width : Field_Width := 0)
     renames Put_Long_Long_Integer;

   subtype Digit_Count is Positive range 1 .. 8;

   procedure Put_Hex (Val : Unsigned_32; Digit_Number : Digit_Count) is
      Hex_Digits : constant String (1 .. 16) := "0123456789ABCDEF";
   begin
      for Place in reverse 0 .. Digit_Number - 1 loop
         Put_Noupdate (Hex_Digits (1 + Natural (Shift_Right (Val, 4 * Place) and 16#F#)));
      end loop;
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
      LCD.Show (Canvas);
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

begin
   LCD.Power_On;
   Clear_Screen;
end NXT.Display;
