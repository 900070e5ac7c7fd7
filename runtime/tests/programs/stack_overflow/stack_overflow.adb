--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Overflowing;
pragma Unreferenced (Overflowing);

procedure Stack_Overflow with Priority => 1 is
begin
   null;
end Stack_Overflow;
