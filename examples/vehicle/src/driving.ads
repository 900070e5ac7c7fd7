--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  One control period of the vehicle: commands of the joystick and the buttons, speeds of the
--  wheels, both controllers, motors.
--
--  Touch sensor on port 1: start and stop. Angle of motor A: steering, positive to the left.
--  Motor B: left wheel; motor C: right wheel. Orange button: stop and power off. At a start the
--  left button selects the open loop, in which set-points go to the motors as they are, and the
--  right button the step response, in which both set-points are 4 V until the next touch.

with Speed_Controller;
with NXT;
with NXT.Battery;
with Quantities;
with Speedometer;

package Driving is

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

   type Vehicle is limited private;

   procedure Start (This : in out Vehicle);
   --  To be called once, before Control.

   procedure Control (This : in out Vehicle);
   --  One period. Before the co-processor has answered, nothing moves.

   function Current_Status (This : Vehicle) return Status;

private

   type Controllers is array (Wheel) of Speed_Controller.Work_Area;

   type Vehicle is limited record
      Now         : Status;
      Meter       : Speedometer.Meter;
      Work        : Controllers;
      Touched     : Boolean := True;
      Power_Held  : Boolean := True;
   end record;
   --  Touched and Power_Held: as in the period before; only a new press counts.

   Motor_Of : constant array (Wheel) of NXT.Motor_Id :=
     (Left => NXT.Motor_B, Right => NXT.Motor_C);

   Joystick_Motor : constant NXT.Motor_Id := NXT.Motor_A;

   --  The maximum of the set-point leaves the controller a reserve below the battery's voltage
   Reserve       : constant Quantities.Volts := 2.0;
   Cruise_Share  : constant Quantities.Volts := 0.8;
   Step_Setpoint : constant Quantities.Volts := 4.0;

   --  Steering: the inner wheel slows down in proportion to the angle and stands at Full_Lock
   Dead_Zone : constant Quantities.Degrees := 2;
   Full_Lock : constant Quantities.Degrees := 90;

end Driving;
