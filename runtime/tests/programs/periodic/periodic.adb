--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Cyclic;
pragma Unreferenced (Cyclic);

procedure Periodic with Priority => 1 is
begin
   null;
end Periodic;
