--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.Sensor_Ports;  use NXT.Sensor_Ports;

package body NXT.Light_Sensors.Ctors is

   procedure Set_Up (Port : Sensor_Id; Lamp : Pin_States) is
   begin
      Set_Input_Power (Port, Standard_Power);
      Set_Pin_State (Port, Digital_0, Lamp);
      Set_Pin_State (Port, Digital_1, Low);
      Set_Pin_Mode (Port, Digital_0, Output);
      Set_Pin_Mode (Port, Digital_1, Output);
   end Set_Up;

   function Make (Port : Sensor_Id; Floodlight_On : Boolean := False) return Light_Sensor is
   begin
      Set_Up (Port, (if Floodlight_On then High else Low));
      return (Port => Port, Floodlight => Floodlight_On, others => <>);
   end Make;

end NXT.Light_Sensors.Ctors;
