--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.I2C_Ports;
with NXT.Sensor_Ports;

package body NXT.Ultrasonic_Sensors.Ctors is

   use Ada.Real_Time;

   Default_Address : constant := 2;

   --  From the call until the co-processor has switched the supply and the sensor has started
   Start_Up : constant Time_Span := Milliseconds (200);

   function Make (Port : Sensor_Id) return Ultrasonic_Sensor is
     (Make (Port, Default_Address, Continuous));

   function Make
     (Port           : Sensor_Id;
      Device_Address : Unsigned_32;
      Mode           : Commanded_Operating_Mode)
      return Ultrasonic_Sensor
   is
      Ready : constant Time := Clock + Start_Up;
   begin
      I2C_Ports.Configure_I2C_Port (Port, I2C_Ports.LEGO_Mode);
      Sensor_Ports.Set_Input_Power (Port, NXT_9V);
      return This : Ultrasonic_Sensor :=
        (I2C_Sensor with Mode => Mode, Mode_Is_Pending => True,
         Next_Command => Ready, Next_Reading => Ready)
      do
         This.Set_Port_Id (Port);
         This.Set_Device_Address (Device_Address);
      end return;
   end Make;

end NXT.Ultrasonic_Sensors.Ctors;
