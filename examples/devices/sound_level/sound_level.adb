--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A sound sensor on port 2: the level as a number and as a bar.

with Ada.Real_Time;            use Ada.Real_Time;
with NXT.AVR;
with NXT.Display;              use NXT.Display;
with NXT.Display.Drawing;      use NXT.Display.Drawing;
with NXT.Sound_Sensors;        use NXT.Sound_Sensors;
with NXT.Sound_Sensors.Ctors;  use NXT.Sound_Sensors.Ctors;

procedure Sound_Level is

   use NXT;

   Ear   : constant Sound_Sensor := Make (Sensor_2, DBA_Mode => True);
   Next  : Time;
   Level : Integer;
begin
   NXT.AVR.Await_Data_Available;
   Next := Clock + Milliseconds (300);
   loop
      delay until Next;
      Level := Integer'Max (0, Integer'Min (99, Ear.Sound_Level));
      Put_At_Noupdate (0, 0, "level dBA");
      Set_Pos (11, 0);
      Put_Noupdate (Level, Width => 4);
      Fill_Rectangle ((0, 20), (99, 31), Clear);
      Fill_Rectangle ((0, 20), (X_Position (Level), 31));
      Screen_Update;
      Next := Next + Milliseconds (100);
   end loop;
end Sound_Level;
