--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  What the brick has: buttons, ports and the limits of what passes through them.

package NXT with Pure is

   type Button_Id is (No_Button, Power_Button, Left_Button, Middle_Button, Right_Button);
   --  Power_Button is the orange one, Middle_Button the dark grey one below it.

   type Motor_Id is (Motor_A, Motor_B, Motor_C);

   type Sensor_Id is (Sensor_1, Sensor_2, Sensor_3, Sensor_4);

   type PWM_Value is range -100 .. 100 with Size => 8;
   --  Duty cycle of a motor in per cent of the supply voltage; positive is forward.

   type Sensor_Power is (Standard_Power, RCX_9V, NXT_9V);
   --  Supply of a sensor's first pin: none; 9 V except while it is sampled; 9 V always.

   type Color is (No_Color, Black, Blue, Green, Yellow, Red, White);

   type ADC_Value is range 0 .. 1023 with Size => 16;
   --  A sensor reading: 0 V is 0, 5 V is 1023.

   Crystal_Frequency : constant := 18_432_000;
   PLL_Multiplier    : constant := 73;
   PLL_Divider       : constant := 14;

   Clock_Frequency   : constant := Crystal_Frequency * PLL_Multiplier / PLL_Divider / 2;
   --  Frequency in hertz of the processor and of its peripherals, rounded down.

end NXT;
