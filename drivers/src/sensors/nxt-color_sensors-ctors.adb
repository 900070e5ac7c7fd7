--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.Sensor_Ports;  use NXT.Sensor_Ports;

package body NXT.Color_Sensors.Ctors is

   function Make (Port : Sensor_Id; Mode : Lamp_Mode := All_Lamps) return Color_Sensor is
   begin
      Reset (Port);
      return (Port => Port, Mode => Mode, others => <>);
   end Make;

end NXT.Color_Sensors.Ctors;
