--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  One sequence of numbers for each caller; the test replaces the seed in the image

package Random_Numbers is

   type Word is mod 2 ** 32;

   Seed : Word := 16#5EED_0001#
     with Volatile, Export, Convention => C, External_Name => "seed";

   type Generator is limited record
      State : Word := 0;
   end record;

   procedure Start (Sequence : in out Generator; Number : Word);

   function Next (Sequence : in out Generator; Bound : Word) return Word;
   --  0 .. Bound - 1, Bound at most 2**16

   procedure Spend (Turns : Word) with No_Inline;
   --  Some cycles for each turn

end Random_Numbers;
