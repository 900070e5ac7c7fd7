--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  No_Dependence => Ada.Asynchronous_Task_Control

with Ada.Asynchronous_Task_Control;

procedure Asynchronous_Control is
begin
   null;
end Asynchronous_Control;
