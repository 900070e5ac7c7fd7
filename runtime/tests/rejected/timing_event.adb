--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  No_Local_Timing_Events

with Ada.Real_Time.Timing_Events;

procedure Timing_Event is
   Event : Ada.Real_Time.Timing_Events.Timing_Event;
begin
   null;
end Timing_Event;
