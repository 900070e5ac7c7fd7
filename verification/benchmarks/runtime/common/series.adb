--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body Series is

   State : Unsigned_32 := 16#2545_F491#;

   type Words is array (1 .. 4) of Unsigned_32;

   Scratch : array (1 .. 2) of Words := (others => (others => 1)) with Volatile_Components;

   procedure Note (To : in out Summary; Sample : Cycles) is
   begin
      To.Count := To.Count + 1;
      To.Sum := To.Sum + Sample;
      if Sample < To.Best then
         To.Best := Sample;
      end if;
      if Sample > To.Worst then
         To.Worst := Sample;
      end if;
   end Note;

   function Random (Bound : Unsigned_32) return Unsigned_32 is
   begin
      State := State xor Shift_Left (State, 13);
      State := State xor Shift_Right (State, 17);
      State := State xor Shift_Left (State, 5);
      return Shift_Right (State, 16) mod Bound;
   end Random;

   procedure Spend (Turns : Unsigned_32) is
      Product : Unsigned_32 := 3 with Volatile;
   begin
      for Turn in 1 .. Turns loop
         Product := Product * (Turn or 16#0101_0001#);
         Scratch (2) := Scratch (1);
      end loop;
   end Spend;

end Series;
