--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  No_Dependence => Ada.Execution_Time.Timers

with Ada.Execution_Time.Timers;

procedure Execution_Timers is
begin
   null;
end Execution_Timers;
