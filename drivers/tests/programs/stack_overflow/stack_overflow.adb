--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A task needs more stack than it has; the display tells.

with NXT.Display;

with Digging;
pragma Unreferenced (Digging);

procedure Stack_Overflow is
begin
   NXT.Display.Put ("Digging");
end Stack_Overflow;
