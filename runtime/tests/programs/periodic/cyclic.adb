--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;

package body Cyclic is

   use Interfaces;

   Start : constant Time := Time_Of (0, Milliseconds (5));

   procedure Repeat (Index : Positive; Period : Time_Span) is
      Next : Time := Start;
      Late : Integer_32;
   begin
      loop
         delay until Next;
         Late := Integer_32 ((Clock - Next) / Time_Span_Unit);
         if Late < 0 or else Late > Latest_Lateness (Index) then
            Latest_Lateness (Index) := Late;
         end if;
         Jobs (Index) := Jobs (Index) + 1;
         Next := Next + Period;
      end loop;
   end Repeat;

   task body One is
   begin
      Repeat (1, Microseconds (1_375));
   end One;

   task body Two is
   begin
      Repeat (2, Milliseconds (2));
   end Two;

   task body Three is
   begin
      Repeat (3, Milliseconds (7));
   end Three;

   task body Four is
   begin
      Repeat (4, Milliseconds (50));
   end Four;

end Cyclic;
