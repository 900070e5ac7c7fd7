--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Contenders;
pragma Unreferenced (Contenders);

procedure Stress with Priority => 1 is
begin
   null;
end Stress;
