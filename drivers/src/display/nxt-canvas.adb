--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.Priorities;

package body NXT.Canvas is

   use Interfaces;
   use NXT.LCD;

   subtype Next_Column is Natural range 0 .. Char_Columns'Last + 1;
   --  One beyond the last: the next letter begins a new row.

   type Block is array (1 .. 7) of Unsigned_32;
   type Blocks is array (1 .. Pixel_Rows'Last * Full_Line'Size / Block'Size) of Block;
   --  All rows but one: they move in less than half the time, for which tasks wait.

   protected Screen with Priority => Priorities.Shared_Data is
      procedure Clear;
      procedure Move (To_Column : Char_Columns; To_Row : Char_Rows);
      procedure New_Line;
      procedure Write (Text : String);
      procedure Write_At (First : Char_Columns; At_Row : Char_Rows; Text : String);
      procedure Mix (At_Row : Pixel_Rows; At_Column : Pixel_Columns; How : Pattern);
      procedure Update;
   private
      procedure Scroll;
      procedure Draw (Letter : Character; At_Column : Char_Columns; At_Row : Char_Rows);
      procedure Write_Letter (Letter : Character);
      Content : Picture := (others => (others => 0));
      Column  : Next_Column := 0;
      Row     : Char_Rows := 0;
   end Screen;

   protected body Screen is

      procedure Clear is
      begin
         Content := (others => (others => 0));
         Column := 0;
         Row := 0;
      end Clear;

      procedure Move (To_Column : Char_Columns; To_Row : Char_Rows) is
      begin
         Column := To_Column;
         Row := To_Row;
      end Move;

      procedure Scroll is
         Lower : Blocks with Import, Address => Content (1)'Address;
         Upper : Blocks with Import, Address => Content (0)'Address;
      begin
         for Part in Blocks'Range loop
            Upper (Part) := Lower (Part);
         end loop;
         Content (Pixel_Rows'Last) := (others => 0);
      end Scroll;

      procedure New_Line is
      begin
         Column := 0;
         if Row < Char_Rows'Last then
            Row := Row + 1;
         else
            Scroll;
         end if;
      end New_Line;

      procedure Draw (Letter : Character; At_Column : Char_Columns; At_Row : Char_Rows) is
         Left  : constant Fonts.Letter_Edges := Fonts.Left_Edge (At_Column);
         Shape : Fonts.Glyph renames Fonts.Shape_Of (Letter);
      begin
         for Part in Fonts.Glyph_Columns loop
            pragma Loop_Optimize (Unroll);
            Content (At_Row) (Left + Part) := Shape (Part);
         end loop;
      end Draw;

      procedure Write_Letter (Letter : Character) is
      begin
         if Column > Char_Columns'Last then
            New_Line;
         end if;
         Draw (Letter, Column, Row);
         Column := Column + 1;
      end Write_Letter;

      procedure Write_At (First : Char_Columns; At_Row : Char_Rows; Text : String) is
         Next : Char_Columns := First;
      begin
         for Letter of Text loop
            pragma Annotate (Ravenbrick, Iterations, 16, "the letters of a row");
            Draw (Letter, Next, At_Row);
            exit when Next = Char_Columns'Last;
            Next := Next + 1;
         end loop;
      end Write_At;

      procedure Write (Text : String) is
      begin
         for Letter of Text loop
            pragma Annotate (Ravenbrick, Iterations, 16, "NXT.Display writes pieces of a row");
            case Letter is
               when ASCII.CR => Column := 0;
               when ASCII.LF => New_Line;
               when others   => Write_Letter (Letter);
            end case;
         end loop;
      end Write;

      procedure Mix (At_Row : Pixel_Rows; At_Column : Pixel_Columns; How : Pattern) is
         Pixels : Unsigned_8 renames Content (At_Row) (At_Column);
      begin
         Pixels := (Pixels and How.Keep) xor How.Flip;
      end Mix;

      procedure Update is
      begin
         LCD.Show (Content);
      end Update;

   end Screen;

   procedure Clear is
   begin
      Screen.Clear;
   end Clear;

   procedure Move (Column : Char_Columns; Row : Char_Rows) is
   begin
      Screen.Move (Column, Row);
   end Move;

   procedure New_Line is
   begin
      Screen.New_Line;
   end New_Line;

   procedure Write (Text : String) is
   begin
      Screen.Write (Text);
   end Write;

   procedure Write_At (Column : Char_Columns; Row : Char_Rows; Text : String) is
   begin
      Screen.Write_At (Column, Row, Text);
   end Write_At;

   procedure Mix (Row : LCD.Pixel_Rows; Column : LCD.Pixel_Columns; How : Pattern) is
   begin
      Screen.Mix (Row, Column, How);
   end Mix;

   procedure Update is
   begin
      Screen.Update;
   end Update;

begin
   LCD.Power_On;
   Update;
end NXT.Canvas;
