--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Samples of a duration, of which the best, the mean and the worst are kept

with Interfaces; use Interfaces;

package Series is

   subtype Cycles is Unsigned_32;

   type Summary is record
      Count : Unsigned_32 := 0;
      Best  : Cycles := Cycles'Last;
      Worst : Cycles := 0;
      Sum   : Unsigned_32 := 0;
   end record
     with Volatile, Convention => C;
   --  In cycles of the processor

   procedure Note (To : in out Summary; Sample : Cycles);

   function Random (Bound : Unsigned_32) return Unsigned_32;
   --  0 .. Bound - 1, Bound at most 2**16; for one caller

   procedure Spend (Turns : Unsigned_32) with No_Inline;
   --  Some cycles for each turn, with multiplications and stores of several words

end Series;
