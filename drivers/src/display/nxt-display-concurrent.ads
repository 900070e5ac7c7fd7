--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  NXT.Display for several tasks under the names of the package that the University of Padova added
--  to GNAT for MINDSTORMS. NXT.Display is safe for several tasks itself: programs of today use it.

package NXT.Display.Concurrent is

   procedure Clear renames Clear_Screen;

   procedure Put (C : Character) renames NXT.Display.Put;
   procedure Put (S : String) renames NXT.Display.Put;
   procedure Put_Line (S : String) renames NXT.Display.Put_Line;

   procedure Put (V : Integer);

   procedure Put_Timed (S : String);
   --  Milliseconds since the start of the program, and a line of text.

   procedure Newline renames NXT.Display.Newline;

   procedure Put_Hex (Val : Interfaces.Unsigned_32) renames NXT.Display.Put_Hex;
   procedure Put_Hex (Val : Interfaces.Unsigned_16) renames NXT.Display.Put_Hex;
   procedure Put_Hex (Val : Interfaces.Unsigned_8) renames NXT.Display.Put_Hex;

end NXT.Display.Concurrent;
