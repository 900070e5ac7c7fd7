--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;
with NXT.Bus_Log;

procedure Bus_Log is
begin
   NXT.Bus_Log.Run_Scenarios;
   delay until Ada.Real_Time.Time_Last;
end Bus_Log;
