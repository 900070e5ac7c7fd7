--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Late_Tasks;
with Journal;

procedure Sequential with Priority => 1 is
begin
   Journal.Note ('m');
   Late_Tasks.Note_Main;
end Sequential;
