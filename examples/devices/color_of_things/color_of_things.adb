--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A colour sensor on port 3: which colour lies before it, and its parts.

with Ada.Real_Time;            use Ada.Real_Time;
with NXT.AVR;
with NXT.Color_Sensors;        use NXT.Color_Sensors;
with NXT.Color_Sensors.Ctors;  use NXT.Color_Sensors.Ctors;
with NXT.Display;              use NXT.Display;

procedure Color_Of_Things is

   use NXT;

   subtype Word is String (1 .. 10);
   Name_Of : constant array (Color) of Word :=
     (No_Color => "no sensor ", Black => "black     ", Blue => "blue      ", Green => "green     ",
      Yellow => "yellow    ", Red => "red       ", White => "white     ");

   Eye    : Color_Sensor := Make (Sensor_3);
   Seen   : Surface;
   Status : Measurement_Status;
   Next   : Time;
begin
   NXT.AVR.Await_Data_Available;
   Next := Clock;
   loop
      Eye.Measure (Seen, Status);
      Put_At_Noupdate (0, 0, Name_Of (if Status = Measured then Color_Of (Seen) else No_Color));
      Put_At_Noupdate (0, 2, "red   green blue");
      Set_Pos (0, 3);
      Put_Noupdate (Integer (Seen.Red), Width => 3);
      Set_Pos (6, 3);
      Put_Noupdate (Integer (Seen.Green), Width => 3);
      Set_Pos (12, 3);
      Put (Integer (Seen.Blue), Width => 3);
      Next := Next + Milliseconds (100);
      delay until Next;
   end loop;
end Color_Of_Things;
