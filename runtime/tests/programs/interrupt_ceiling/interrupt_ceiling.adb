--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Masked;
pragma Unreferenced (Masked);

procedure Interrupt_Ceiling with Priority => 1 is
begin
   null;
end Interrupt_Ceiling;
