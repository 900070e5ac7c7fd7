--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  No_Dependence => Ada.Execution_Time.Group_Budgets

with Ada.Execution_Time.Group_Budgets;

procedure Group_Budgets is
begin
   null;
end Group_Budgets;
