--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Expiring;

procedure Events with Priority => 1 is
begin
   Expiring.Be_Busy;
end Events;
