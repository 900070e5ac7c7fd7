--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ending;
pragma Unreferenced (Ending);

procedure Termination with Priority => 1 is
begin
   null;
end Termination;
