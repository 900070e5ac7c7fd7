--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A brick that executes direct commands over USB and does nothing else.

with Ada.Real_Time;  use Ada.Real_Time;
with Host_Link;

procedure Direct_USB is
begin
   Host_Link.Server.Require;
   delay until Time_Last;
end Direct_USB;
