--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Ten lines on a screen of eight, one after the other.

with Ada.Real_Time;
with NXT.Display;  use NXT.Display;

procedure Display_Scroll is
begin
   for Line in 1 .. 10 loop
      Put_Noupdate ("line ");
      Put_Noupdate (Line);
      if Line < 10 then
         New_Line;
      end if;
   end loop;
   Screen_Update;
   delay until Ada.Real_Time.Time_Last;
end Display_Scroll;
