--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;

package body Greeting is

   task body Hello is
      Next : Time := Time_First;
   begin
      loop
         delay until Next;
         Count := Count + 1;
         Next := Next + Milliseconds (500);
      end loop;
   end Hello;

end Greeting;
