--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;

package body NXT.Display.Concurrent is

   use Ada.Real_Time;

   Start : constant Time := Clock;

   procedure Put (V : Integer) is
   begin
      NXT.Display.Put (V, Width => 0);
   end Put;

   procedure Put_Timed (S : String) is
   begin
      Put_Noupdate ((Clock - Start) / Milliseconds (1));
      Put_Noupdate (' ');
      Put_Line (S);
   end Put_Timed;

end NXT.Display.Concurrent;
