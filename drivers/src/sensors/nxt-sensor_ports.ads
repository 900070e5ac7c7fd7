--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The four sensor ports: the two digital lines (pins 5 and 6 of the plug) and the supply on pin 1.
--  What the pins mean is the sensor's business; packages such as NXT.Light_Sensors set them.

with NXT.Registers.PIO;

package NXT.Sensor_Ports with Elaborate_Body is

   type Pin_Id is (Digital_0, Digital_1);

   procedure Reset (Port : Sensor_Id);
   --  Both lines inputs, no 9 V: as for a touch sensor.

   procedure Reset_All_Ports;

   type Modes is (Off, Input, Output, ADC);

   procedure Set_Pin_Mode (Port : Sensor_Id; Pin : Pin_Id; Mode : Modes)
     with Pre => Mode /= ADC or else Pin = Digital_1;
   --  Off and Input let the line be pulled up; Output drives it to the state last set, or Low. ADC
   --  is Input, and the processor's own converter measures the line.

   procedure Convert (Port : Sensor_Id; Before : out ADC_Value);
   --  Measure Digital_1 in the mode ADC: starts a conversion, which takes at most 45 us, and gives
   --  the result of the one before; 3.3 V is 1023.

   type Pin_States is (Low, High);

   function Current_State (Port : Sensor_Id; Pin : Pin_Id) return Pin_States;
   --  The level on the line.

   procedure Set_Pin_State (Port : Sensor_Id; Pin : Pin_Id; Value : Pin_States);
   --  Takes effect while the pin's mode is Output.

   procedure Set_Input_Power (Port : Sensor_Id; Kind : Sensor_Power);
   --  See NXT.AVR.Set_Input_Power.

   type Port_Lines is array (Sensor_Id, Pin_Id) of Registers.Line;

   Line_Of : constant Port_Lines :=
     (Sensor_1 => (Registers.PIO.Digital_0 (Sensor_1), Registers.PIO.Digital_1 (Sensor_1)),
      Sensor_2 => (Registers.PIO.Digital_0 (Sensor_2), Registers.PIO.Digital_1 (Sensor_2)),
      Sensor_3 => (Registers.PIO.Digital_0 (Sensor_3), Registers.PIO.Digital_1 (Sensor_3)),
      Sensor_4 => (Registers.PIO.Digital_0 (Sensor_4), Registers.PIO.Digital_1 (Sensor_4)));
   --  Lines of the input and output controller A.

end NXT.Sensor_Ports;
