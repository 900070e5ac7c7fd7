--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Threads_Of_Three_Priorities;

procedure Preemption with Priority => 1 is
begin
   Threads_Of_Three_Priorities.Start;
end Preemption;
