--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Order of what happened, for the test that reads it from outside

package Journal is

   Capacity : constant := 200;

   Marks : String (1 .. Capacity) := (others => ' ')
     with Volatile, Export, Convention => C, External_Name => "journal";

   Length : Natural := 0
     with Volatile, Export, Convention => C, External_Name => "journal_length";

   procedure Note (Mark : Character);
   --  Append Mark; what does not fit is lost

end Journal;
