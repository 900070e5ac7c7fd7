--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;

with Leaving;

procedure Last_Task with Priority => 1 is
begin
   if Leaving.Main_Stays = 1 then
      delay until Time_Last;
   end if;
end Last_Task;
