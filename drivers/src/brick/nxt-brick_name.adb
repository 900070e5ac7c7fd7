--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body NXT.Brick_Name is

   type Stored_Name is record
      Length  : Natural;
      Letters : String (1 .. Longest);
   end record;

   package Memory is new Parameters.Store (Stored_Name, Id => 8, Format => 1);

   function Name return String is
      Item  : Stored_Name := (Default'Length, Default & (Default'Length + 1 .. Longest => ' '));
      Found : Boolean;
   begin
      Memory.Load (Item, Found);
      return (if Found and then Item.Length in 1 .. Longest
              then Item.Letters (1 .. Item.Length)
              else Default);
   end Name;

   procedure Set_Name (Text : String; Result : out Parameters.Save_Result) is
   begin
      Memory.Save
        ((Text'Length, Text & (1 .. Longest - Text'Length => ' ')), Result);
   end Set_Name;

end NXT.Brick_Name;
