--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Text, numbers and drawings on the display.

with Ada.Real_Time;        use Ada.Real_Time;
with NXT.AVR;
with NXT.Display;          use NXT.Display;
with NXT.Display.Drawing;  use NXT.Display.Drawing;
pragma Unreferenced (NXT.AVR);
--  The power button switches the brick off.

procedure Text_Display is
   Smile : constant Bitmap := (16#3C#, 16#42#, 16#95#, 16#A1#, 16#A1#, 16#95#, 16#42#, 16#3C#);
begin
   Put_At_Noupdate (0, 0, "Hello, brick!");
   Draw_Rectangle ((2, 12), (60, 60));
   Draw_Line ((2, 12), (60, 60));
   Fill_Rectangle ((70, 30), (90, 60));
   Draw_Line ((70, 60), (90, 30), Clear);
   Draw_Bitmap ((76, 14), Smile);
   Screen_Update;
   delay until Time_Last;
end Text_Display;
