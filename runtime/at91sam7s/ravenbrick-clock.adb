--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Interfaces; use Interfaces;

with Ravenbrick.Processor;
with Ravenbrick.Registers; use Ravenbrick.Registers;

package body Ravenbrick.Clock is

   Enabled_Longest_Period : constant Word := 16#010F_FFFF#;
   --  PITEN, no interrupt; PIV at its maximum makes PIIR one 32-bit count

   type Observation is record
      Last  : Count := 0;
      Wraps : Count := 0;
   end record
     with Volatile;

   Seen : Observation;

   function To_Units (Wraps, Low : Count) return Units is
     (Units_Per_Tick * Units (Shift_Left (Unsigned_64 (Wraps), 32) or Unsigned_64 (Low)))
     with Inline_Always;

   procedure Start is
      Discarded : Word with Volatile;
   begin
      PIT.PIT_MR := Enabled_Longest_Period;
      Discarded := PIT.PIT_PIVR;
   end Start;

   procedure Observe (Now : out Units; At_Count : out Count) is
      Wraps : Count := Seen.Wraps;
   begin
      At_Count := PIT.PIT_PIIR;
      if At_Count < Seen.Last then
         Wraps := Wraps + 1;
         Seen.Wraps := Wraps;
      end if;
      Seen.Last := At_Count;
      Now := To_Units (Wraps, At_Count);
   end Observe;

   function Since (Start : Count) return Units is
     (Units (Count'(Units_Per_Tick * (PIT.PIT_PIIR - Start))));

   --  The order of the three reads matters: an interrupt that notes a wrap between them either
   --  leaves a Last above the count, which is then read again, or is in Wraps already

   function Now return Units is
      Last     : constant Count := Seen.Last;
      Wraps    : constant Count := Seen.Wraps;
      Present  : Count := PIT.PIT_PIIR;
      Previous : Processor.Status;
      Result   : Units;
   begin
      if Present >= Last then
         return To_Units (Wraps, Present);
      end if;
      Processor.Mask_Interrupts (Previous);
      Observe (Now => Result, At_Count => Present);
      Processor.Restore_Interrupts (Previous);
      return Result;
   end Now;

end Ravenbrick.Clock;
