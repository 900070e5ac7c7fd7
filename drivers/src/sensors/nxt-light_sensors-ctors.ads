--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  How light sensors come to be.

package NXT.Light_Sensors.Ctors is

   function Make (Port : Sensor_Id; Floodlight_On : Boolean := False) return Light_Sensor;
   --  The light sensor at a port, which is set up for it, with its lamp on or off.

end NXT.Light_Sensors.Ctors;
