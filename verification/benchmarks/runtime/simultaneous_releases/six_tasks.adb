--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;

with Interfaces; use Interfaces;

package body Six_Tasks is

   State : Unsigned_32 := 1;
   Step  : Time_Span := Milliseconds (1) with Volatile;
   --  Until the next release. The last task to run sets it, when all others wait.

   procedure Draw is
   begin
      State := State * 69_069 + 1;
      Step := Time_Span_Unit * (16_000 + Integer (Shift_Right (State, 20)));
   end Draw;

   task body Cyclic is
      Next : Time := Time_Of (0, Milliseconds (5));
   begin
      for Sample in 1 .. Samples loop
         delay until Next;
         Next := Next + Step;
         if Rank = Last_Rank then
            Draw;
         end if;
      end loop;
      Finished := True;
      delay until Time_Last;
   end Cyclic;

end Six_Tasks;
