--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Path_Tasks;
pragma Unreferenced (Path_Tasks);

procedure Code_Paths with Priority => 1 is
begin
   null;
end Code_Paths;
