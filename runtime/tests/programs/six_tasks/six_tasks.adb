--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Six;
pragma Unreferenced (Six);

procedure Six_Tasks with Priority => 1 is
begin
   null;
end Six_Tasks;
