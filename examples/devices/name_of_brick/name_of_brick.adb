--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The brick's name, which stays when the battery is taken out, and why the program started.

with Ada.Real_Time;
with NXT.Brick_Name;  use NXT.Brick_Name;
with NXT.Display;     use NXT.Display;
with NXT.Parameters;
with NXT.Power;       use NXT.Power;
with NXT.Watchdog;

procedure Name_Of_Brick is

   subtype Word is String (1 .. 10);
   Words : constant array (Reset_Cause) of Word :=
     (Power_On => "power on  ", Watchdog => "watchdog  ", Software => "software  ",
      Reset_Pin => "reset pin ", Brown_Out => "brown-out ");

   Result : NXT.Parameters.Save_Result;
begin
   Set_Name ("Robin", Result);
   Put_At_Noupdate (0, 0, "name  " & Name);
   Put_At_Noupdate (0, 1, "start " & Words (Last_Reset));
   Put_At (0, 2, (if NXT.Watchdog.Enabled then "watchdog on " else "watchdog off"));
   delay until Ada.Real_Time.Time_Last;
end Name_Of_Brick;
