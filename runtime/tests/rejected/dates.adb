--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  No_Dependence => Ada.Calendar

with Ada.Calendar;

procedure Dates is
   Now : Ada.Calendar.Time := Ada.Calendar.Clock;
begin
   null;
end Dates;
