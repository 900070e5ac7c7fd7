--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body Ravenbrick.Failures is

   Terminated : String (1 .. Longest_Text + 1);
   --  Static, because the handler takes a stack that the caller may be using

   procedure Stop_With (Text : String; Line : Natural) is
      Length : constant Natural := Natural'Min (Text'Length, Longest_Text);
   begin
      for Index in 1 .. Length loop
         Terminated (Index) := Text (Text'First + Index - 1);
      end loop;
      Terminated (Length + 1) := ASCII.NUL;
      Stop (Terminated'Address, Line);
   end Stop_With;

end Ravenbrick.Failures;
