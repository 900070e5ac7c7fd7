--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Greeting;
pragma Unreferenced (Greeting);

procedure Two_Tasks is
begin
   null;
end Two_Tasks;
