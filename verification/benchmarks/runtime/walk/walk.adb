--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Walking;
pragma Unreferenced (Walking);

procedure Walk with Priority => 1 is
begin
   null;
end Walk;
