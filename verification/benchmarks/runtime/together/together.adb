--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Six;
pragma Unreferenced (Six);

procedure Together with Priority => 1 is
begin
   null;
end Together;
