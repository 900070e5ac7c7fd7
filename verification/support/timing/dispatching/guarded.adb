--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  An operation of an interface that a protected type implements

with Ada.Real_Time; use Ada.Real_Time;
with Values;        use Values;

procedure Guarded with Priority => 12 is
   Next  : Time := Clock + Milliseconds (20);
   Count : Natural := 0 with Volatile;
begin
   loop
      delay until Next;
      Count := (Count + 1) mod 50;
      That_Signal.Send;
      Next := Next + Milliseconds (4);
   end loop;
end Guarded;
