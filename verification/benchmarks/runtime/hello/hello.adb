--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Greeting;
pragma Unreferenced (Greeting);

procedure Hello is
begin
   null;
end Hello;
