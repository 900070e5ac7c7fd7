--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A task calls a protected object whose ceiling is below its priority; the display tells.

with NXT.Display;

with Low_Ceiling;
pragma Unreferenced (Low_Ceiling);

procedure Ceiling_Violation is
begin
   NXT.Display.Put ("Waiting");
end Ceiling_Violation;
