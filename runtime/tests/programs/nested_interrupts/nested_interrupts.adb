--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Handlers;
pragma Unreferenced (Handlers);

procedure Nested_Interrupts with Priority => 1 is
begin
   null;
end Nested_Interrupts;
