--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A function that dispatches by the tag of another operand, which the .ali file calls static

with Ada.Real_Time; use Ada.Real_Time;
with Values;        use Values;

procedure Made_Anew with Priority => 12 is
   Next  : Time := Clock + Milliseconds (20);
   Count : Natural := 0 with Volatile;
begin
   loop
      delay until Next;
      Count := (Count + 1) mod 50;
      This_Value := (if Count = 7 then A_Wide'Access else A_Value'Access);
      Take (This_Value.all, Made);
      Next := Next + Milliseconds (4);
   end loop;
end Made_Anew;
