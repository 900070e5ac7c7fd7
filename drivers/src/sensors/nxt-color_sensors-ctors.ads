--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  How colour sensors come to be.

package NXT.Color_Sensors.Ctors is

   function Make (Port : Sensor_Id; Mode : Lamp_Mode := All_Lamps) return Color_Sensor;
   --  The colour sensor at a port. It is reset into its mode by the first measurement, or by
   --  Set_Mode.

end NXT.Color_Sensors.Ctors;
