--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  No_Dependence => Ada.Task_Attributes

with Ada.Task_Attributes;

procedure Task_Attributes is
begin
   null;
end Task_Attributes;
