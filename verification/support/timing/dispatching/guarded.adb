--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  An operation of an interface that a protected type implements

with Pace;
with Values; use Values;

procedure Guarded with Priority => 12 is
begin
   loop
      delay until Pace.Next;
      That_Signal.Send;
   end loop;
end Guarded;
