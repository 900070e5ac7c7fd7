--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Six_Tasks;
pragma Unreferenced (Six_Tasks);

procedure Simultaneous_Releases with Priority => 1 is
begin
   null;
end Simultaneous_Releases;
