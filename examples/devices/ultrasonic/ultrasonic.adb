--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  An ultrasonic sensor on port 4: the distance to the nearest thing.

with Ada.Real_Time;                 use Ada.Real_Time;
with NXT.Display;                   use NXT.Display;
with NXT.Ultrasonic_Sensors;        use NXT.Ultrasonic_Sensors;
with NXT.Ultrasonic_Sensors.Ctors;  use NXT.Ultrasonic_Sensors.Ctors;

procedure Ultrasonic is

   use NXT;

   Sonar    : Ultrasonic_Sensor := Make (Sensor_4);
   Distance : Centimetres;
   Status   : Measurement_Status;
   Next     : Time := Clock;
begin
   loop
      Sonar.Measure (Distance, Status);
      case Status is
         when Measured =>
            Put_At_Noupdate (0, 0, "distance      cm");
            Set_Pos (9, 0);
            Put (Integer (Distance), Width => 4);
         when No_Echo =>
            Put_At (0, 0, "nothing there   ");
         when No_Answer =>
            Put_At (0, 0, "no sensor       ");
      end case;
      Next := Next + Milliseconds (100);
      delay until Next;
   end loop;
end Ultrasonic;
