--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A group of eight signals every 4 ms, 11 KB/s with their frames: a count and the
--  parameter's value seven times.

with Ada.Real_Time;  use Ada.Real_Time;
with NXT.Telemetry;  use NXT.Telemetry;
with USB_Link;

procedure Telemetry_USB is

   use USB_Link;

   Period : constant Time_Span := Milliseconds (4);
   Next   : Time := Clock;
   Count  : Natural := 0;
   Gain   : Value;

   Published : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "published";
begin
   Server.Require;
   loop
      Gain := Of_Real (Current (Ki));
      Publish (1, (Of_Whole (Count), Gain, Gain, Gain, Gain, Gain, Gain, Gain));
      Count := Count + 1;
      Published := Count;
      Next := Next + Period;
      delay until Next;
   end loop;
end Telemetry_USB;
