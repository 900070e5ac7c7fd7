--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with System;

with Workers;

procedure Idle_Main
  with Priority => System.Priority'First
is
begin
   Workers.Do_Nothing;
end Idle_Main;
