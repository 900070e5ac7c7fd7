--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.AVR;

package body NXT.Touch_Sensors is

   function Pressed (This : Touch_Sensor) return Boolean is
     (NXT.AVR.Reading (This.Port) < Pressed_Below);

end NXT.Touch_Sensors;
