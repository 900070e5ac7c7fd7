--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Sized;
pragma Unreferenced (Sized);

procedure Stacks with Priority => 7 is
begin
   null;
end Stacks;
