--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  What a joystick tells a vehicle through the air, one frame each 20 ms: drive or stop, and the
--  angle of the stick. Both programs share this package.

with NXT.Bytes;
with NXT.Frames;

package Joystick_Commands with Pure is

   Vehicle_Name : constant String := "remote vehicle";
   Vehicle_Pin  : constant String := "2468";

   Period_Ms : constant := 20;

   type Steering is range -90 .. 90;
   --  Degrees, positive to the left.

   type Command is record
      Running : Boolean := False;
      Angle   : Steering := 0;
   end record;

   subtype Content is NXT.Bytes.Byte_Array (1 .. 3);

   function To_Content (Item : Command) return Content;

   function Is_Command (Item : NXT.Frames.Reader) return Boolean;
   --  Whether the frame that has come is one, with an angle in its range.

   function To_Command (Item : NXT.Frames.Reader) return Command with
     Pre => Is_Command (Item);

end Joystick_Commands;
