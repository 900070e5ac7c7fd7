--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Worst_Cases;

procedure Worst_Case_Services with Priority => 1 is
begin
   Worst_Cases.Play;
end Worst_Case_Services;
