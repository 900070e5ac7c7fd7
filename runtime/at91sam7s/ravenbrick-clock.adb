--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Interfaces; use Interfaces;

with Ravenbrick.Processor;
with Ravenbrick.Registers; use Ravenbrick.Registers;

package body Ravenbrick.Clock is

   use type Units;

   Enabled_Longest_Period : constant Word := 16#010F_FFFF#;
   --  PITEN, no interrupt; PIV at its maximum makes PIIR one 32-bit count

   type Observation is record
      Last  : Unsigned_32 := 0;
      Wraps : Unsigned_32 := 0;
   end record
     with Volatile;

   Seen : Observation;

   function To_Units (Wraps, Count : Unsigned_32) return Units is
     (Units_Per_Tick * Units (Shift_Left (Unsigned_64 (Wraps), 32) or Unsigned_64 (Count)))
     with Inline_Always;

   procedure Start is
      Discarded : Word with Volatile;
   begin
      PIT.Mode := Enabled_Longest_Period;
      Discarded := PIT.Value_Clear;
   end Start;

   procedure Observe is
      Count : constant Unsigned_32 := PIT.Image;
   begin
      if Count < Seen.Last then
         Seen.Wraps := Seen.Wraps + 1;
      end if;
      Seen.Last := Count;
   end Observe;

   --  The order of the three reads matters: an interrupt that notes a wrap between them either
   --  leaves a Last above Count, which is looked at again, or is in Wraps already

   function Now return Units is
      Last     : constant Unsigned_32 := Seen.Last;
      Wraps    : constant Unsigned_32 := Seen.Wraps;
      Count    : constant Unsigned_32 := PIT.Image;
      Previous : Processor.Status;
      Result   : Units;
   begin
      if Count >= Last then
         return To_Units (Wraps, Count);
      end if;
      Processor.Mask_Interrupts (Previous);
      Observe;
      Result := To_Units (Seen.Wraps, Seen.Last);
      Processor.Restore_Interrupts (Previous);
      return Result;
   end Now;

end Ravenbrick.Clock;
