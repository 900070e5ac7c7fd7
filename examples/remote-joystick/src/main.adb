--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The joystick of ../remote-vehicle: the tasks do the work.

with Ada.Real_Time;
with NXT.AVR;
with Stick;
with Stick_Tasks;
with System;
pragma Unreferenced (NXT.AVR, Stick, Stick_Tasks);

procedure Main with Priority => System.Priority'First is
begin
   delay until Ada.Real_Time.Time_Last;
end Main;
