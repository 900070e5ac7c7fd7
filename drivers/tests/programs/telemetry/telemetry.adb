--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A group of three signals every 4 ms and one of a single signal every 100 ms; the first signal
--  is the second parameter's value.

with Ada.Real_Time;         use Ada.Real_Time;
with NXT.Telemetry;         use NXT.Telemetry;
with Robot_Link;

procedure Telemetry is

   use Robot_Link;

   Period     : constant Time_Span := Milliseconds (4);
   Slow_Every : constant := 25;
   Next       : Time := Clock;
   Count      : Natural := 0;

   Published : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "published";
begin
   Server.Require;
   loop
      Publish
        (1, (Of_Real (Current (Ki)), Of_Whole (Count), Of_Truth (Count mod 2 = 1)));
      if Count mod Slow_Every = 0 then
         Publish (2, (1 => Of_Real (Float (Count) / 4.0)));
      end if;
      Count := Count + 1;
      Published := Count;
      Next := Next + Period;
      delay until Next;
   end loop;
end Telemetry;
