--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body Journal is

   procedure Note (Mark : Character) is
   begin
      if Length < Capacity then
         Length := Length + 1;
         Marks (Length) := Mark;
      end if;
   end Note;

end Journal;
