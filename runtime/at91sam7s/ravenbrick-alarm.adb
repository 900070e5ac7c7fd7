--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Interfaces; use Interfaces;

with Ravenbrick.Clock;
with Ravenbrick.Registers; use Ravenbrick.Registers;

package body Ravenbrick.Alarm is

   use type Threads.Units;

   --  CMR: waveform mode up to RC, clock stopped by the compare (datasheet 33.6.5)
   Fine_Mode   : constant Word := 16#C040#;
   Coarse_Mode : constant Word := 16#C044#;

   Enable_And_Trigger : constant Word := 2#101#;
   Compare_Event      : constant Word := 2#1_0000#;

   Fine_Counts_Per_Tick : constant := 8;
   Units_Per_Coarse     : constant := 448;
   --  1024 cycles

   Fine_Limit : constant := 57_000;
   --  Units whose fine count still fits 16 bits

   Coarse_Margin  : constant := 2;
   Longest_Coarse : constant := 65_000;
   Longest_Units  : constant := (Longest_Coarse + Coarse_Margin) * Units_Per_Coarse;

   --  Both quotients are products with a reciprocal in 32 bits: a division would be a loop of up to
   --  230 cycles in Thumb code, with interrupts masked

   function Ticks (Span : Word) return Word is
     (Shift_Right ((Span + Clock.Units_Per_Tick - 1) * 74_899, 19))
     with Inline_Always;
   --  Span / 7, rounded up: exact below Fine_Limit because 7 * 74_899 = 2**19 + 5

   function Coarse_Counts (Span : Word) return Word is
     (Shift_Right (Shift_Right (Span, 6) * 9_362, 16))
     with Inline_Always;
   --  At most Span / 448, at least 2 less, and 127 from Fine_Limit on: 7 * 9_362 = 2**16 - 2

   Handler_Lead : constant := 24;
   --  Fine counts that surely pass from the request until the handler reads the clock

   Shortest_Fine : constant := 2;

   procedure Trigger (Mode, Count : Word) with Inline;

   procedure Trigger (Mode, Count : Word) is
   begin
      TC0.TC_CMR := Mode;
      TC0.TC_RC := Count;
      TC0.TC_CCR := Enable_And_Trigger;
   end Trigger;

   procedure Initialize is
   begin
      PMC.PMC_PCER := Shift_Left (1, Natural (TC0_Id));
      TC0.TC_IER := Compare_Event;
   end Initialize;

   procedure Set (Remaining : Threads.Units; Spent : Fine_Count) is
      Early : constant Word := Word (Spent + Handler_Lead);
      Mode  : Word := Coarse_Mode;
      Count : Word := Longest_Coarse;
   begin
      if Remaining < Longest_Units then
         if Remaining >= Fine_Limit then
            Count := Coarse_Counts (Word (Remaining)) - Coarse_Margin;
         else
            Mode := Fine_Mode;
            Count := Shortest_Fine;
            if Remaining > 0 then
               Count := Word'Max
                 (Ticks (Word (Remaining)) * Fine_Counts_Per_Tick, Early + Shortest_Fine) - Early;
            end if;
         end if;
      end if;
      Trigger (Mode, Count);
   end Set;

   procedure Acknowledge is
      Discarded : constant Word := TC0.TC_SR;
      pragma Unreferenced (Discarded);
   begin
      null;
   end Acknowledge;

end Ravenbrick.Alarm;
