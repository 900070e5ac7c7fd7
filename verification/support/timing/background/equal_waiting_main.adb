--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with System;

with Workers;

procedure Equal_Waiting_Main
  with Priority => System.Priority'First + 10
is
begin
   Workers.Wait_And_Hold_Again;
end Equal_Waiting_Main;
