--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with System;

with Workers;

procedure Holding_Main
  with Priority => System.Priority'First + 9
is
begin
   Workers.Hold_Object;
end Holding_Main;
