--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Timed;
pragma Unreferenced (Timed);

procedure Timing_Events with Priority => 1 is
begin
   null;
end Timing_Events;
