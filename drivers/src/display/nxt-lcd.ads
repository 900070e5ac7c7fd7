--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The display controller (UltraChip UC1601 datasheet): 100 columns of 8 pages, a byte of a page is
--  eight pixels, the lowest bit on top. Columns and pages count from the upper left corner.

with Interfaces;
with NXT.SPI;

package NXT.LCD is

   use type Interfaces.Unsigned_8;

   subtype Pixel_Columns is Natural range 0 .. 99;
   subtype Pixel_Rows    is Natural range 0 .. 7;
   --  Rows of eight pixels.

   type LCD_Line is array (Pixel_Columns range <>) of Interfaces.Unsigned_8;
   subtype Full_Line is LCD_Line (Pixel_Columns);
   type Picture is array (Pixel_Rows) of Full_Line with Alignment => 4;

   procedure Power_On;
   --  Reset the controller, set it up and switch the display on. Delays the caller by 40 ms.

   procedure Show (Content : Picture);
   --  Copy Content, to be sent in the background; returns at once. The transfer lasts 4 ms. What
   --  is shown while a transfer goes on follows it; of several such pictures only the last does.
   --  For any number of tasks.

   --  Single settings and pages; each waits until its bytes are through. For one task at a time.

   subtype Raw_Columns is Natural range 0 .. 131;
   subtype Raw_Pages   is Natural range 0 .. 8;
   --  Of the controller's memory, of which the display shows a part.

   procedure Write (Page : Raw_Pages; Start : Raw_Columns; Graph : LCD_Line)
     with Pre => Graph'Length > 0;
   --  Part of a page, from a column on. The next Show overwrites it.

   procedure Command (Cmd : Interfaces.Unsigned_8);

   procedure Reset;
   procedure Set_Display_Enable (On : Boolean);
   procedure Set_All_Pixels_On (On : Boolean);
   procedure Set_Inverse_Display (On : Boolean);

   subtype Bias_Ratio is Interfaces.Unsigned_8 range 0 .. 3;
   procedure Set_Bias_Ratio (Br : Bias_Ratio);
   --  3 is 1/9.

   procedure Set_Pot (Pm : Interfaces.Unsigned_8);
   --  Contrast.

   subtype Address_Control is Interfaces.Unsigned_8 range 0 .. 7;
   procedure Set_Ram_Address_Control (Ac : Address_Control);
   --  Bit 0: go on with the next page after the last column; bit 1: page before column; bit 2:
   --  pages backwards.

   subtype Mapping is Interfaces.Unsigned_8 range 0 .. 3;
   procedure Set_Map_Control (M : Mapping);
   --  Bit 0: mirror columns; bit 1: mirror lines, which the brick needs.

   procedure Set_Col (Ca : Raw_Columns);
   procedure Set_Page_Address (Pa : Raw_Pages);

   subtype Scroll_Lines is Interfaces.Unsigned_8 range 0 .. 63;
   procedure Set_Scroll (N : Scroll_Lines);

   Set_Up : constant NXT.SPI.Byte_Array;
   --  The commands after a reset up to and including the one that switches the display on.

private

   Reset_Command : constant := 16#E2#;

   Set_Up : constant NXT.SPI.Byte_Array :=
     (16#23#,            --  multiplex rate 1/65
      16#27#,            --  temperature compensation
      16#29#,            --  panel loading
      16#2F#,            --  internal supply of the panel
      16#EB#,            --  bias 1/9
      16#81#, 16#5A#,    --  contrast
      16#A0#,            --  frame rate
      16#88#,            --  stay on the page after its last column
      16#C4#,            --  mirror lines
      16#40#,            --  no scrolling
      16#A4#, 16#A6#,    --  pixels as in memory, not inverse
      16#AF#);           --  on

end NXT.LCD;
