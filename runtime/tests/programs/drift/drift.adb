--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Release_Lateness;
pragma Unreferenced (Release_Lateness);

procedure Drift with Priority => 1 is
begin
   null;
end Drift;
