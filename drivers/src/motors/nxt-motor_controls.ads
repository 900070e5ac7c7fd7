--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Motion of single motors.

package NXT.Motor_Controls is

   subtype Duty_Cycle is PWM_Value;

   type Decay is (Slow, Fast);
   --  What the current does while the bridge does not drive: Slow, through the shorted windings,
   --  the mean voltage is proportional to the duty cycle; Fast, back into the supply.

   procedure Drive (Motor : Motor_Id; Duty : Duty_Cycle; Off_Phase : Decay := Slow);

   procedure Brake (Motor : Motor_Id);
   --  Short the windings.

   procedure Coast (Motor : Motor_Id);
   --  Leave the windings open.

   procedure Brake_All;

   generic
      type Volts is digits <>;
   function To_Duty (Control, Battery : Volts) return Duty_Cycle;
   --  The duty cycle whose mean voltage is Control; full duty when the battery gives less.

   --  As course programs know it

   subtype Power_Percentage is PWM_Value range 0 .. 100;

   type Motion_Modes is (Forward, Backward, Brake, Coast);

   procedure Control_Motor (Motor : Motor_Id; Power : Power_Percentage; Mode : Motion_Modes);
   --  Power has no meaning for Brake and Coast.

end NXT.Motor_Controls;
