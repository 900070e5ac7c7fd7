--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Each kind of drawing at the place that test_display.py expects.

with Ada.Real_Time;
with NXT.Display;          use NXT.Display;
with NXT.Display.Drawing;  use NXT.Display.Drawing;

procedure Display_Drawing is
begin
   Draw_Line ((0, 0), (9, 4));
   Draw_Line ((19, 0), (10, 9));
   Draw_Line ((25, 9), (25, 0));
   Draw_Rectangle ((30, 3), (39, 12));
   Fill_Rectangle ((49, 17), (42, 2));
   Fill_Rectangle ((44, 5), (46, 10), Clear);
   Draw_Bitmap ((60, 5), (16#FF#, 16#01#, 16#81#));
   Draw_Bitmap ((98, 60), (16#FF#, 16#FF#, 16#FF#));
   Fill_Rectangle ((70, 0), (79, 9));
   Draw_Line ((70, 5), (79, 5), Inverse);
   Draw_Rectangle ((85, 3), (85, 3));
   Draw_Rectangle ((88, 3), (89, 4), Inverse);
   Draw_Pixel ((0, 63));
   Put_At (0, 7, "gjpqy");
   delay until Ada.Real_Time.Time_Last;
end Display_Drawing;
