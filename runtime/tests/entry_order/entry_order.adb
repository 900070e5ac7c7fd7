--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Callers;
with Journal;

procedure Entry_Order with Priority => 5 is
begin
   delay 0.010;
   Callers.Gate.Open;
   delay 0.010;
   Callers.Meeting.Pass;
   Journal.Note ('p');
end Entry_Order;
