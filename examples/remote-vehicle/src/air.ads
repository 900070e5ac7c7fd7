--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The vehicle's end of the air: whoever knows the code connects, and the last command counts
--  until it is too old.

with Joystick_Commands;
with System;

package Air is

   Longest_Silence_Ms : constant := 200;

   type Contact is (Nobody, Silent, Heard);

   procedure Get (Command : out Joystick_Commands.Command; State : out Contact);
   --  Silent: connected, but the last command is older than Longest_Silence_Ms. Command means
   --  'stop' unless State is Heard.

   task Radio_Task is
      pragma Priority (System.Priority'First);
      pragma Storage_Size (2048);
   end Radio_Task;
   --  Every 10 ms: what has come.

end Air;
