--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Two_Waiters;
pragma Unreferenced (Two_Waiters);

procedure Second_Suspended with Priority => 1 is
begin
   null;
end Second_Suspended;
