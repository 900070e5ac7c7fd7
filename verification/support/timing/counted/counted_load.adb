--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Workers;
pragma Unreferenced (Workers);

procedure Counted_Load is
begin
   null;
end Counted_Load;
