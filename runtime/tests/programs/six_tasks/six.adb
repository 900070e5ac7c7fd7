--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;

package body Six is

   Period : constant Time_Span := Milliseconds (5);

   task body Cyclic is
      Next : Time := Time_Of (0, Milliseconds (5));
   begin
      loop
         delay until Next;
         Next := Next + Period;
      end loop;
   end Cyclic;

end Six;
