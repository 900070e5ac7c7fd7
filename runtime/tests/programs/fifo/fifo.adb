--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Equals;
pragma Unreferenced (Equals);

procedure Fifo with Priority => 1 is
begin
   null;
end Fifo;
