--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;

package body Overflowing is

   type Words is array (1 .. 12) of Integer with Volatile_Components;

   function Recurse (Deeper : Natural) return Integer with No_Inline;

   function Recurse (Deeper : Natural) return Integer is
      Local : Words := (others => Deeper);
   begin
      if Deeper > 0 then
         Local (1) := Recurse (Deeper - 1) + 1;
      end if;
      return Local (1) + Local (12);
   end Recurse;

   task body Recursive_Task is
      Next : Time := Time_Of (0, Milliseconds (2));
   begin
      loop
         delay until Next;
         Next := Next + Milliseconds (1);
         if Recurse (Depth) >= 0 then
            Depth := Depth + 1;
         end if;
      end loop;
   end Recursive_Task;

end Overflowing;
