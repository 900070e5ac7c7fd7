--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.Sensor_Ports;  use NXT.Sensor_Ports;

package body NXT.Sound_Sensors.Ctors is

   function Make (Port : Sensor_Id; DBA_Mode : Boolean) return Sound_Sensor is
   begin
      Set_Input_Power (Port, Standard_Power);
      Select_Mode (Port, DBA_Mode);
      Set_Pin_Mode (Port, Digital_0, Output);
      Set_Pin_Mode (Port, Digital_1, Output);
      return (Port => Port, Weighted => DBA_Mode);
   end Make;

end NXT.Sound_Sensors.Ctors;
