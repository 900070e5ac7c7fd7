--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  No_Specific_Termination_Handlers

with Ada.Task_Identification;
with Ada.Task_Termination;

procedure Specific_Handler is
begin
   Ada.Task_Termination.Set_Specific_Handler (Ada.Task_Identification.Current_Task, null);
end Specific_Handler;
