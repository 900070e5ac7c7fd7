--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  What the vehicle shows of itself: one consistent set of values for the display, and single
--  symbols for an observer of the memory.

with NXT.Battery;
with Quantities;

package Panel with Elaborate_Body is

   type Drive_Mode is (Stopped, Closed_Loop, Open_Loop, Step_Response, Off);

   type Wheel is (Left, Right);

   type Wheel_Values is record
      Setpoint : Quantities.Volts := 0.0;
      Speed    : Quantities.Volts := 0.0;
      Control  : Quantities.Volts := 0.0;
   end record;
   --  Speed is the measured one; Control goes to the motor.

   type Wheel_Pair is array (Wheel) of Wheel_Values;

   type Status is record
      Mode     : Drive_Mode := Stopped;
      Wheels   : Wheel_Pair;
      Joystick : Quantities.Degrees := 0;
      Battery  : NXT.Battery.Supply_Millivolts := 0;
   end record;

   procedure Publish (Now : Status);

   procedure Draw;
   --  Show the last Status published.

end Panel;
