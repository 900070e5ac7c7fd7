--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  One control period of the line follower: touch sensor, brightness, steering, wheels.
--
--  Each press of the touch sensor on port 1 starts or stops. The light sensor on port 3 follows
--  the left edge of a black line.

package Following is

   type Status is record
      Running    : Boolean := False;
      Brightness : Float := 0.0;
      Steering   : Float := 0.0;
   end record;
   --  0 on black to 1 on white; volts, positive to the left.

   procedure Start;
   --  To be called once, before Control: lamp on.

   procedure Control;
   --  One period.

   function Latest return Status;

end Following;
