--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Handled_Twice;
with Journal;
pragma Unreferenced (Handled_Twice);

procedure Second_Handler with Priority => 1 is
begin
   Journal.Note ('m');
end Second_Handler;
