--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A task needs more stack than it has; the display tells.

with NXT.Display;

with Recursion;
pragma Unreferenced (Recursion);

procedure Stack_Overflow is
begin
   NXT.Display.Put ("Recursion");
end Stack_Overflow;
