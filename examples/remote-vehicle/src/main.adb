--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The vehicle of ../vehicle with a joystick in the air: the tasks do the work.

with Ada.Real_Time;
with Air;
with NXT.AVR;
with Remote_Tasks;
with System;
pragma Unreferenced (Air, NXT.AVR, Remote_Tasks);

procedure Main with Priority => System.Priority'First is
begin
   delay until Ada.Real_Time.Time_Last;
end Main;
