--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.AVR;

package body NXT.Motor_Controls is

   procedure Drive (Motor : Motor_Id; Duty : Duty_Cycle; Off_Phase : Decay := Slow) is
   begin
      NXT.AVR.Set_Output (Motor, Duty, Short_When_Off => Off_Phase = Slow);
   end Drive;

   procedure Brake (Motor : Motor_Id) is
   begin
      NXT.AVR.Set_Output (Motor, 0, Short_When_Off => True);
   end Brake;

   procedure Coast (Motor : Motor_Id) is
   begin
      NXT.AVR.Set_Output (Motor, 0, Short_When_Off => False);
   end Coast;

   procedure Brake_All is
   begin
      for Motor in Motor_Id loop
         Brake (Motor);
      end loop;
   end Brake_All;

   function To_Duty (Control, Battery : Volts) return Duty_Cycle is
   begin
      return
        (if Control >= Battery then PWM_Value'Last
         elsif Control <= -Battery then PWM_Value'First
         else PWM_Value (100.0 * Control / Battery));
   end To_Duty;

   procedure Control_Motor (Motor : Motor_Id; Power : Power_Percentage; Mode : Motion_Modes) is
   begin
      case Mode is
         when Forward  => Drive (Motor, Duty_Cycle (Power));
         when Backward => Drive (Motor, -Duty_Cycle (Power));
         when Brake    => Brake (Motor);
         when Coast    => Coast (Motor);
      end case;
   end Control_Motor;

end NXT.Motor_Controls;
