--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The main procedure only brings the parts together; the tasks do the work.

with Ada.Real_Time;
with Live;
with NXT.AVR;
with System;
with Tasks;
pragma Unreferenced (NXT.AVR, Tasks);

procedure Main with Priority => System.Priority'First is
begin
   Live.Server.Require;
   delay until Ada.Real_Time.Time_Last;
end Main;
