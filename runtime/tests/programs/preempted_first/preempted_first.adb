--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Pair;
pragma Unreferenced (Pair);

procedure Preempted_First with Priority => 1 is
begin
   null;
end Preempted_First;
