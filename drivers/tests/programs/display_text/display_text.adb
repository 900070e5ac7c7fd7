--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Text, numbers and hexadecimal on the display, at the places that test_display.py expects.

with Ada.Real_Time;
with Interfaces;   use Interfaces;
with NXT.Display;  use NXT.Display;

procedure Display_Text is
begin
   Put_Line ("Hello, brick!");
   Put_Noupdate (Integer'First);
   Put_Noupdate (Integer'(42), Width => 5);
   Newline_Noupdate;
   Put_Hex (Unsigned_32'(16#00C0FFEE#));
   Newline_Noupdate;
   Put_Noupdate ("sixteen columns and on");
   Set_Pos (10, 6);
   Put_Noupdate (Long_Long_Integer'First / 10 ** 14);
   Set_Pos (0, 7);
   Put ("{|}~ !""#$%&'()*+");
   delay until Ada.Real_Time.Time_Last;
end Display_Text;
