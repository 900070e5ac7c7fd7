--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Loaded;
pragma Unreferenced (Loaded);

procedure Load with Priority => 1 is
begin
   null;
end Load;
