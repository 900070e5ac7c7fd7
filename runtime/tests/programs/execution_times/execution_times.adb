--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Timed;

procedure Execution_Times with Priority => 1 is
begin
   Timed.Work;
end Execution_Times;
