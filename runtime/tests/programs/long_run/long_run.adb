--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Infrequent_Task;
pragma Unreferenced (Infrequent_Task);

procedure Long_Run with Priority => 1 is
begin
   null;
end Long_Run;
