--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A colour sensor at port 2: colours every 20 ms; the left button changes over to the red lamp,
--  the right one back.

with Ada.Real_Time;            use Ada.Real_Time;
with NXT.AVR;
with NXT.Color_Sensors.Ctors;  use NXT.Color_Sensors, NXT.Color_Sensors.Ctors;

procedure Color is

   use NXT;

   type Numbers is array (Positive range <>) of Integer;

   Parts : Numbers (1 .. 4) := (others => -1) with
     Volatile, Export, Convention => C, External_Name => "parts";
   Named : Integer := -1 with Volatile, Export, Convention => C, External_Name => "named";
   Level : Integer := -1 with Volatile, Export, Convention => C, External_Name => "level";
   Status : Integer := -1 with Volatile, Export, Convention => C, External_Name => "status";
   Rounds : Integer := 0 with Volatile, Export, Convention => C, External_Name => "rounds";

   Eye    : Color_Sensor := Make (Sensor_2);
   Seen   : Surface;
   Light  : Percentage;
   Result : Measurement_Status;
   Next   : Time;

   procedure Follow_Buttons is
      Wanted : constant Lamp_Mode :=
        (case NXT.AVR.Button is
            when Left_Button   => Red_Lamp,
            when Right_Button  => All_Lamps,
            when others        => Eye.Mode);
   begin
      if Wanted /= Eye.Mode then
         Eye.Set_Mode (Wanted, Result);
      end if;
   end Follow_Buttons;

begin
   NXT.AVR.Await_Data_Available;
   Next := Clock;
   loop
      Follow_Buttons;
      if Eye.Mode = All_Lamps then
         Eye.Measure (Seen, Result);
         Parts := (Integer (Seen.Red), Integer (Seen.Green), Integer (Seen.Blue),
                   Integer (Seen.Background));
         Named := NXT.Color'Pos (Color_Of (Seen));
      else
         Eye.Measure_Light (Light, Result);
         Level := Light;
      end if;
      Status := Measurement_Status'Pos (Result);
      Rounds := Rounds + 1;
      Next := Time'(Clock) + Milliseconds (20);
      delay until Next;
   end loop;
end Color;
