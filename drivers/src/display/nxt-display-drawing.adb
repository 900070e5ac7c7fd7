--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.Canvas;
with NXT.LCD;

package body NXT.Display.Drawing is

   use Interfaces;

   Row_Height : constant := 8;

   function Pattern_Of (Pixels : Unsigned_8; Colour : Ink) return Canvas.Pattern is
     (case Colour is
         when Dark    => (Keep => not Pixels, Flip => Pixels),
         when Clear   => (Keep => not Pixels, Flip => 0),
         when Inverse => (Keep => 16#FF#, Flip => Pixels));

   --  Eight pixels from a line down, which are in one row of the canvas or in two.
   procedure Draw_Column (X : X_Position; Top : Natural; Pixels : Unsigned_8; Colour : Ink) is
      Row   : constant LCD.Pixel_Rows := Top / Row_Height;
      Shift : constant Natural := Top mod Row_Height;
      Lower : constant Unsigned_8 := Shift_Right (Pixels, Row_Height - Shift);
   begin
      Canvas.Mix (Row, Natural (X), Pattern_Of (Shift_Left (Pixels, Shift), Colour));
      if Lower /= 0 and then Row < LCD.Pixel_Rows'Last then
         Canvas.Mix (Row + 1, Natural (X), Pattern_Of (Lower, Colour));
      end if;
   end Draw_Column;

   procedure Draw_Pixel (At_Point : Point; Colour : Ink := Dark) is
   begin
      Draw_Column (At_Point.X, Natural (At_Point.Y), 1, Colour);
   end Draw_Pixel;

   procedure Draw_Line (From, To : Point; Colour : Ink := Dark) is
      X      : Integer := Integer (From.X);
      Y      : Integer := Integer (From.Y);
      Width  : constant Natural := abs (Integer (To.X) - X);
      Height : constant Natural := abs (Integer (To.Y) - Y);
      Step_X : constant Integer := (if To.X >= From.X then 1 else -1);
      Step_Y : constant Integer := (if To.Y >= From.Y then 1 else -1);
      Error  : Integer := Width - Height;
      Twice  : Integer;
   begin
      for Pixel in 0 .. Natural'Max (Width, Height) loop
         Draw_Column (X_Position (X), Y, 1, Colour);
         exit when Pixel = Natural'Max (Width, Height);
         Twice := 2 * Error;
         if Twice > -Height then
            Error := Error - Height;
            X := X + Step_X;
         end if;
         if Twice < Width then
            Error := Error + Width;
            Y := Y + Step_Y;
         end if;
      end loop;
   end Draw_Line;

   procedure Fill_Rectangle (Corner, Opposite : Point; Colour : Ink := Dark) is
      Bottom : constant Natural := Natural (Y_Position'Max (Corner.Y, Opposite.Y));
      Top    : Natural := Natural (Y_Position'Min (Corner.Y, Opposite.Y));
      Lines  : Natural;
   begin
      while Top <= Bottom loop
         Lines := Natural'Min (Row_Height - Top mod Row_Height, Bottom - Top + 1);
         for X in X_Position'Min (Corner.X, Opposite.X) .. X_Position'Max (Corner.X, Opposite.X)
         loop
            Draw_Column (X, Top, Unsigned_8 (2 ** Lines - 1), Colour);
         end loop;
         Top := Top + Lines;
      end loop;
   end Fill_Rectangle;

   procedure Draw_Rectangle (Corner, Opposite : Point; Colour : Ink := Dark) is
      Left   : constant X_Position := X_Position'Min (Corner.X, Opposite.X);
      Right  : constant X_Position := X_Position'Max (Corner.X, Opposite.X);
      Top    : constant Y_Position := Y_Position'Min (Corner.Y, Opposite.Y);
      Bottom : constant Y_Position := Y_Position'Max (Corner.Y, Opposite.Y);
   begin
      Fill_Rectangle ((Left, Top), (Right, Top), Colour);
      if Bottom > Top then
         Fill_Rectangle ((Left, Bottom), (Right, Bottom), Colour);
      end if;
      if Bottom - Top > 1 then
         Fill_Rectangle ((Left, Top + 1), (Left, Bottom - 1), Colour);
         if Right > Left then
            Fill_Rectangle ((Right, Top + 1), (Right, Bottom - 1), Colour);
         end if;
      end if;
   end Draw_Rectangle;

   procedure Draw_Bitmap (Upper_Left : Point; Image : Bitmap; Colour : Ink := Dark) is
      Visible : constant Natural :=
        Natural'Min (Image'Length, Natural (X_Position'Last - Upper_Left.X) + 1);
   begin
      for Column in 0 .. Visible - 1 loop
         Draw_Column
           (Upper_Left.X + X_Position (Column), Natural (Upper_Left.Y),
            Image (Image'First + Column), Colour);
      end loop;
   end Draw_Bitmap;

end NXT.Display.Drawing;
