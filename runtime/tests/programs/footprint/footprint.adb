--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Everything;
pragma Unreferenced (Everything);

procedure Footprint with Priority => 1 is
begin
   null;
end Footprint;
