--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Low_Ceiling;
pragma Unreferenced (Low_Ceiling);

procedure Ceiling_Violation with Priority => 1 is
begin
   null;
end Ceiling_Violation;
