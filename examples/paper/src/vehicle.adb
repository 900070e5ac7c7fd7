--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The main procedure: the background of the tasks of Tasks, Live and NXT.AVR.

with Live;
with NXT.AVR;
with System;
with Tasks;
pragma Unreferenced (NXT.AVR, Tasks);

procedure Vehicle is
   pragma Priority (System.Priority'First);
begin
   Live.Server.Require;
   loop
      null;
   end loop;
end Vehicle;
