--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A joystick of a motor and a touch sensor: its task finds the vehicle, connects, and tells it
--  the command of each period.

with System;

package Stick is

   type Contact is (Looking, Calling, Connected);

   type Status is record
      Contact : Stick.Contact := Looking;
      Running : Boolean := False;
      Angle   : Integer := 0;
   end record;

   function Latest return Status;

   task Radio_Task is
      pragma Priority (System.Priority'First + 2);
      pragma Storage_Size (2048);
   end Radio_Task;
   --  While connected every 20 ms: motor A's angle and the touch sensor's presses in, a command
   --  out.

end Stick;
