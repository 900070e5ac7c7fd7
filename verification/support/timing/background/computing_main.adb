--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with System;

with Workers;

procedure Computing_Main
  with Priority => System.Priority'First
is
begin
   Workers.Compute;
end Computing_Main;
