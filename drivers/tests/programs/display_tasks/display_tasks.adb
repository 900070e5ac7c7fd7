--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Writers;

procedure Display_Tasks with Priority => 1 is
begin
   Writers.Keep_Updating;
end Display_Tasks;
