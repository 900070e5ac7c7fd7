--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with System;

with Workers;

procedure Waiting_Main
  with Priority => System.Priority'First
is
begin
   Workers.Wait_And_Hold_Again;
end Waiting_Main;
