--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A vehicle with a wired joystick: the main procedure only brings the parts together.

with Ada.Real_Time;
with NXT.AVR;
with System;
with Tasks;
pragma Unreferenced (NXT.AVR, Tasks);
--  Their tasks do the work.

procedure Vehicle with Priority => System.Priority'First is
begin
   delay until Ada.Real_Time.Time_Last;
end Vehicle;
