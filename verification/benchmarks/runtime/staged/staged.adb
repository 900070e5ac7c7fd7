--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Stage;

procedure Staged with Priority => 1 is
begin
   Stage.Play;
end Staged;
