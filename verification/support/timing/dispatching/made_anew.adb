--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A function that dispatches by the tag of another operand, which the .ali file calls static

with Pace;
with Values; use Values;

procedure Made_Anew with Priority => 12 is
begin
   loop
      delay until Pace.Next;
      This_Value := (if Pace.Count = 7 then A_Wide'Access else A_Value'Access);
      Take (This_Value.all, Made);
   end loop;
end Made_Anew;
