--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Restarts the watchdog for two seconds, then hangs.

with Ada.Real_Time;  use Ada.Real_Time;
with NXT.Power;
with NXT.Watchdog;

procedure Watchdog is

   Cause : Integer := -1 with
     Volatile, Export, Convention => C, External_Name => "cause";
   Enabled : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "enabled";
   Rounds : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "rounds";

begin
   Cause := NXT.Power.Reset_Cause'Pos (NXT.Power.Last_Reset);
   Enabled := Boolean'Pos (NXT.Watchdog.Enabled);
   for Round in 1 .. 20 loop
      NXT.Watchdog.Restart;
      Rounds := Round;
      delay until Clock + Milliseconds (100);
   end loop;
   loop
      null;
   end loop;
end Watchdog;
