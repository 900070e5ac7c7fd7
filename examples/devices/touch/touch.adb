--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Counts how often a touch sensor on port 1 was pressed.

with Ada.Real_Time;      use Ada.Real_Time;
with NXT.Display;        use NXT.Display;
with NXT.Touch_Sensors;  use NXT.Touch_Sensors;

procedure Touch is

   use NXT;

   Bumper  : Touch_Sensor (Sensor_1);
   Next    : Time := Clock;
   Count   : Natural := 0;
   Before  : Boolean := False;
   Now     : Boolean;
begin
   Put_At (0, 0, "pressed");
   loop
      Now := Bumper.Pressed;
      if Now and then not Before then
         Count := Count + 1;
         Set_Pos (8, 0);
         Put (Count, Width => 4);
      end if;
      Before := Now;
      Next := Next + Milliseconds (10);
      delay until Next;
   end loop;
end Touch;
