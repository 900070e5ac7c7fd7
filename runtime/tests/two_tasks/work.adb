--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;

package body Work is

   task body A is
      Next : Time := Clock;
   begin
      loop
         A_Count := A_Count + 1;
         Next := Next + Milliseconds (2);
         delay until Next;
      end loop;
   end A;

   task body B is
      Next : Time := Clock;
   begin
      loop
         B_Count := B_Count + 1;
         Next := Next + Milliseconds (5);
         delay until Next;
      end loop;
   end B;

end Work;
