--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  One period of balancing. For the first second the robot must be held upright and still: the
--  gyro's count at rest is measured. Then it balances until it falls.

package Balance is

   type Modes is (Calibrating, Balancing, Fallen);

   type Status is record
      Mode          : Modes := Calibrating;
      Pitch         : Float := 0.0;
      Motor_Voltage : Float := 0.0;
      Rest          : Float := 0.0;
   end record;
   --  Radians, volts, counts.

   procedure Control;
   --  One period. Before the co-processor has answered, nothing moves.

   function Latest return Status;

end Balance;
