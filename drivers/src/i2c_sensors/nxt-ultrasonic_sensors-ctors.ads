--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  How ultrasonic sensors come to be.

package NXT.Ultrasonic_Sensors.Ctors is

   function Make (Port : Sensor_Id) return Ultrasonic_Sensor;
   --  The sensor at a port in Continuous mode, with the device address 2.

   function Make
     (Port           : Sensor_Id;
      Device_Address : Unsigned_32;
      Mode           : Commanded_Operating_Mode)
      return Ultrasonic_Sensor;
   --  The port is set up and the sensor gets its 9 V. It is commanded with the first operation,
   --  which waits until it has started.

end NXT.Ultrasonic_Sensors.Ctors;
