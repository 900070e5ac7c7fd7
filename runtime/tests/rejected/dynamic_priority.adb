--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  No_Dynamic_Priorities: Ada.Dynamic_Priorities does not exist here

with Ada.Dynamic_Priorities;

procedure Dynamic_Priority is
begin
   Ada.Dynamic_Priorities.Set_Priority (10);
end Dynamic_Priority;
