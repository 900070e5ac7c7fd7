--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body Random_Numbers is

   procedure Start (Sequence : in out Generator; Number : Word) is
   begin
      Sequence.State := (Seed xor (Number * 16#9E37_79B9#)) or 1;
   end Start;

   function Next (Sequence : in out Generator; Bound : Word) return Word is
      State : Word := Sequence.State;
   begin
      State := State xor (State * 2 ** 13);
      State := State xor (State / 2 ** 17);
      State := State xor (State * 2 ** 5);
      Sequence.State := State;
      return State / 2 ** 16 mod Bound;
   end Next;

   procedure Spend (Turns : Word) is
      Left : Word := Turns with Volatile;
   begin
      while Left > 0 loop
         Left := Left - 1;
      end loop;
   end Spend;

end Random_Numbers;
