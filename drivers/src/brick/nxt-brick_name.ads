--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The brick's name, which it keeps in its flash memory: see NXT.Parameters. 15 letters, as other
--  firmware allows over Bluetooth.

with NXT.Parameters;

package NXT.Brick_Name with Elaborate_Body is

   Longest : constant := 15;

   Default : constant String := "NXT";

   function Name return String
     with Post => Name'Result'Length in 1 .. Longest;
   --  Default until there was another.

   function Is_Allowed (Text : String) return Boolean is
     (Text'Length in 1 .. Longest and then (for all Letter of Text => Letter in ' ' .. '~'));

   procedure Set_Name (Text : String; Result : out Parameters.Save_Result)
     with Pre => Is_Allowed (Text);
   --  Delays the caller as NXT.Parameters does. By one task at a time.

end NXT.Brick_Name;
