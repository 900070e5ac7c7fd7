--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.Display.Drawing;

package body NXT.Graph is

   use NXT.Display.Drawing;

   procedure Clear is
   begin
      NXT.Display.Clear_Screen;
   end Clear;

   procedure Draw_Glyph (X : Graph_Columns; Y : Graph_Rows; Glyph : LCD_Line) is
      Image : Bitmap (1 .. Glyph'Length);
   begin
      for Column in Image'Range loop
         Image (Column) := Glyph (Glyph'First + Column - 1);
      end loop;
      Draw_Bitmap ((X_Position (X), Y_Position (Y)), Image, Inverse);
      NXT.Display.Screen_Update;
   end Draw_Glyph;

end NXT.Graph;
