--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with System;

with Workers;

procedure Urgent_Main
  with Priority => System.Priority'First + 20
is
begin
   Workers.Do_Nothing;
end Urgent_Main;
