--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Equal_Tasks;
pragma Unreferenced (Equal_Tasks);

procedure Equal_Priorities is
begin
   null;
end Equal_Priorities;
