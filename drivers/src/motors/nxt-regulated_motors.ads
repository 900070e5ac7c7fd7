--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Motors with a set speed or a set angle. A task of this package runs the controllers that
--  drivers/regulation/design.py designs and generates, every 4 ms for all motors: a PI controller
--  of the speed, and around it a P controller of the angle. Commands return at once.

with Ada.Real_Time;

package NXT.Regulated_Motors with Elaborate_Body is

   type Degrees is range -2 ** 31 .. 2 ** 31 - 1;

   type Degrees_Per_Second is range -2_000 .. 2_000;

   subtype Regulated_Speed is Degrees_Per_Second range -700 .. 700;
   --  What a motor keeps up under load.

   subtype Turning_Speed is Regulated_Speed range 1 .. Regulated_Speed'Last;

   procedure Run (Motor : Motor_Id; Speed : Regulated_Speed);
   --  Keep up a speed, forward or backward, until another command. With 0 the motor resists.

   procedure Turn_To (Motor : Motor_Id; Angle : Degrees; Speed : Turning_Speed := 500);
   --  Turn to an angle of the encoder at most that fast and hold it: see Arrived.

   procedure Turn_By (Motor : Motor_Id; Angle : Degrees; Speed : Turning_Speed := 500);
   --  Likewise, from the angle that it is to have or, when it is to have none, from where it is.

   type Rest is (Brake, Float);

   procedure Stop (Motor : Motor_Id; Final : Rest := Brake);
   --  End the regulation, with the windings shorted or open.

   type Regulation is (None, Of_Speed, Of_Angle);

   function Regulation_Of (Motor : Motor_Id) return Regulation;
   --  None at the start, after Stop, and after a loss of the co-processor link.

   function Angle (Motor : Motor_Id) return Degrees;

   function Speed (Motor : Motor_Id) return Degrees_Per_Second;
   --  Mean of the last 32 ms, in steps of 31 deg/s.

   Tolerance : constant Degrees := 1;

   function Arrived (Motor : Motor_Id) return Boolean;
   --  Whether a motor with a set angle has come to stand within Tolerance of it, and was not turned
   --  by more than twice that since. It is held there against loads.

   procedure Await_Arrival
     (Motor : Motor_Id; Limit : Ada.Real_Time.Time_Span; Success : out Boolean)
     with Pre => Regulation_Of (Motor) = Of_Angle;
   --  Delay the caller until Arrived, or without Success for Limit or the end of the regulation.

end NXT.Regulated_Motors;
