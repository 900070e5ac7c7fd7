--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Event_Worst_Cases;

procedure Worst_Case_Events with Priority => 1 is
begin
   Event_Worst_Cases.Play;
end Worst_Case_Events;
