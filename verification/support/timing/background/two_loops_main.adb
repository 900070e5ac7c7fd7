--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with System;

with Workers;

procedure Two_Loops_Main
  with Priority => System.Priority'First
is
begin
   for Round in 1 .. 5 loop
      Workers.Wait_And_Hold;
   end loop;
   Workers.Hold_Object;
end Two_Loops_Main;
