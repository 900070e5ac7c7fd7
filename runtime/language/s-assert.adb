--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ravenbrick.Failures;

package body System.Assertions is

   --  The compiler's messages end with <file>:<line>, after a blank when a contract's kind
   --  stands before it

   procedure Raise_Assert_Failure (Msg : String) is
      Line  : Natural := 0;
      Scale : Positive := 1;
      Last  : Integer := Msg'Last;
      First : Integer;
   begin
      while Last > Msg'First and then Msg (Last) in '0' .. '9' and then Scale <= 100_000 loop
         Line := Line + Scale * (Character'Pos (Msg (Last)) - Character'Pos ('0'));
         Scale := Scale * 10;
         Last := Last - 1;
      end loop;
      if Line = 0 or else Msg (Last) /= ':' then
         Ravenbrick.Failures.Stop_With (Msg, Line => 0);
      end if;
      First := Last;
      while First > Msg'First and then Msg (First - 1) /= ' ' loop
         First := First - 1;
      end loop;
      Ravenbrick.Failures.Stop_With (Msg (First .. Last - 1), Line);
   end Raise_Assert_Failure;

end System.Assertions;
