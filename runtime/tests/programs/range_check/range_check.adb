--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Failing_Task;
pragma Unreferenced (Failing_Task);

procedure Range_Check with Priority => 1 is
begin
   null;
end Range_Check;
