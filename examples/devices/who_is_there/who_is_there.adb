--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Any sensor on a two-wire bus: what the one on port 4 says about itself.

with NXT.AVR;
with NXT.Display;                   use NXT.Display;
with NXT.I2C_Sensors;               use NXT.I2C_Sensors;
with NXT.Ultrasonic_Sensors;        use NXT.Ultrasonic_Sensors;
with NXT.Ultrasonic_Sensors.Ctors;  use NXT.Ultrasonic_Sensors.Ctors;
with Ada.Real_Time;

procedure Who_Is_There is

   Sensor : Ultrasonic_Sensor := Make (NXT.Sensor_4);
   Text   : Query_Reply;
   Done   : Boolean;

   procedure Show (Row : Natural; Title : String) is
   begin
      Put_At_Noupdate (0, Row, Title);
      for Place in Text'Range loop
         if Text (Place) = ASCII.NUL then
            Text (Place) := ' ';
         end if;
      end loop;
      Put_At (8, Row, (if Done then Text else "nobody  "));
   end Show;

begin
   NXT.AVR.Await_Data_Available;
   Sensor.Get_Product_Id (Text, Done);
   Show (0, "maker");
   Sensor.Get_Sensor_Type (Text, Done);
   Show (1, "kind");
   Sensor.Get_Version (Text, Done);
   Show (2, "version");
   delay until Ada.Real_Time.Time_Last;
end Who_Is_There;
