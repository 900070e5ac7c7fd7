--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  One control period: the joystick's command, the speeds of the wheels, both controllers, motors.
--  Without a fresh command the wheels brake.

with Air;

package Remote_Driving is

   procedure Start;
   --  To be called once, before Control.

   procedure Control;
   --  One period. Before the co-processor has answered, nothing moves.

   type Status is record
      Driving : Boolean := False;
      Contact : Air.Contact := Air.Nobody;
      Angle   : Integer := 0;
   end record;

   function Latest return Status;

end Remote_Driving;
