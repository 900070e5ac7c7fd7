--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Computing;
pragma Unreferenced (Computing);

procedure Arithmetic with Priority => 1 is
begin
   null;
end Arithmetic;
