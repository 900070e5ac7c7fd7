--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;

package body Computing is

   use type Interfaces.Integer_64;

   function Padded (Image : String) return String is
     ("<" & Image & (Image'Length + 1 .. Text'Last - 2 => '.') & ">");

   --  Leibniz's series in double precision, interrupted all the time

   task body Doubles is
      Term : Long_Float := 4.0;
   begin
      for Index in 0 .. 1_999 loop
         Sum_Of_Doubles := Sum_Of_Doubles + Term / Long_Float (2 * Index + 1);
         Term := -Term;
      end loop;
      Text := Padded (Integer'Image (Rounds - Rounds + 1234));
      delay until Time_Last;
   end Doubles;

   task body Floats is
      Next : Time := Clock;
   begin
      for Index in 1 .. 500 loop
         Sum_Of_Floats := Sum_Of_Floats + 1.0 / Float (Index) ** 2;
         if Index <= 20 then
            Product := Product * Interfaces.Integer_64 (Index);
         end if;
         Rounds := Rounds + 1;
         Next := Next + Microseconds (250);
         delay until Next;
      end loop;
      delay until Time_Last;
   end Floats;

end Computing;
