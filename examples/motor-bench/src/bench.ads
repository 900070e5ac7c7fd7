--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  One control period of the bench: touch sensor, speed of the motor, controllers, motor.
--
--  Each press of the touch sensor on port 1 starts or stops motor B. With the left button held at
--  the start the angle is controlled, otherwise the speed.

package Bench is

   type Modes is (Stopped, Speed, Position);

   procedure Start;
   --  To be called once, before Control.

   procedure Control;
   --  One period.

   type Status is record
      Mode     : Modes := Stopped;
      Setpoint : Float := 0.0;
      Speed    : Float := 0.0;
      Control  : Float := 0.0;
      Angle    : Integer := 0;
   end record;
   --  Volts, 116 degrees per second each; Control is the motor's voltage; Angle in degrees.

   function Latest return Status;

end Bench;
