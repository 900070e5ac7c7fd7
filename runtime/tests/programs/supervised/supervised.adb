--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Watched;
pragma Unreferenced (Watched);

procedure Supervised with Priority => 1 is
begin
   null;
end Supervised;
