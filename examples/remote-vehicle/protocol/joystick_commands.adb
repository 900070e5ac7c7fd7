--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Interfaces;  use Interfaces;
with NXT.Bytes;   use NXT.Bytes;
with NXT.Frames;  use NXT.Frames;

package body Joystick_Commands is

   Code : constant Byte := Character'Pos ('J');
   Zero : constant := 128;
   --  The byte of an angle of 0.

   function Angle_In (Item : Reader) return Integer is
     (Integer (Content_Byte (Item, 3)) - Zero);

   function To_Content (Item : Command) return Content is
     (Code, Boolean'Pos (Item.Running), Byte (Integer (Item.Angle) + Zero));

   function Is_Command (Item : Reader) return Boolean is
     (Content_Length (Item) = Content'Length
      and then Content_Byte (Item, 1) = Code
      and then Content_Byte (Item, 2) <= 1
      and then Angle_In (Item) in Integer (Steering'First) .. Integer (Steering'Last));

   function To_Command (Item : Reader) return Command is
     ((Running => Content_Byte (Item, 2) = 1, Angle => Steering (Angle_In (Item))));

end Joystick_Commands;
