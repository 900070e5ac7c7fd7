--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Day;
pragma Unreferenced (Day);

procedure Drift with Priority => 1 is
begin
   null;
end Drift;
