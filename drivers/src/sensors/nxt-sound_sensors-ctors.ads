--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  How sound sensors come to be.

package NXT.Sound_Sensors.Ctors is

   function Make (Port : Sensor_Id; DBA_Mode : Boolean) return Sound_Sensor;
   --  The sound sensor at a port, which is set up for it.

end NXT.Sound_Sensors.Ctors;
