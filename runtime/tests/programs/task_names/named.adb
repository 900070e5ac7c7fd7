--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body Named is

   procedure Note (Place : Positive; Text : String) is
      First : constant Positive := 1 + 16 * (Place - 1);
   begin
      Images (First .. First + Text'Length - 1) := Text;
   end Note;

   task body With_Name is
   begin
      null;
   end With_Name;

   task body Without_Name is
   begin
      null;
   end Without_Name;

end Named;
