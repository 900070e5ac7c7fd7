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
   if Callers.Platform.Waiting (1) = 1 and then Callers.Platform.Waiting (2) = 1 then
      Callers.Platform.Depart;
   end if;
end Entry_Order;
