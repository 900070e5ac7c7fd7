--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Journal;
with Many_Entries;

procedure Jorvik_Queues with Priority => 5 is
begin
   delay 0.010;
   Journal.Note ('a');
   Many_Entries.Gate.Open (1);
   Journal.Note ('b');
   delay 0.010;
   Many_Entries.Gate.Open (2);
   Journal.Note ('d');
   delay 0.050;
   Journal.Note ('e');
end Jorvik_Queues;
