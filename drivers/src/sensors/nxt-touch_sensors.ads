--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Touch sensors: a switch that pulls the port's analogue line down through a resistor.

pragma Restrictions (No_Tagged_Type_Registration);
--  No type is looked up by its external name

package NXT.Touch_Sensors is

   type Touch_Sensor (Port : Sensor_Id) is tagged limited private;

   function Pressed (This : Touch_Sensor) return Boolean;
   --  As in the last frame from the co-processor; False as long as there was none.

private

   type Touch_Sensor (Port : Sensor_Id) is tagged limited null record;

   --  Half of the supply in the reading's scale: open lines read about 1023, pressed ones 180.
   Pressed_Below : constant ADC_Value := 512;

end NXT.Touch_Sensors;
