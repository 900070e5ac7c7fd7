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

   Handler_Lead : constant := 16;
   --  Fine counts that surely pass from the request until the handler reads the clock

   Shortest_Fine : constant := 2;

   procedure Trigger (Mode, Count : Word) with Inline;

   procedure Trigger (Mode, Count : Word) is
   begin
      TC0.Mode := Mode;
      TC0.Compare := Count;
      TC0.Control := Enable_And_Trigger;
   end Trigger;

   procedure Initialize is
   begin
      PMC.Peripheral_Clock_Enable := Shift_Left (1, Natural (TC0_Id));
      TC0.Enable := Compare_Event;
   end Initialize;

   procedure Set (Remaining : Threads.Units; Spent : Fine_Count) is
      Near  : Word;
      Early : constant Word := Word (Spent + Handler_Lead);
   begin
      if Remaining >= Longest_Units then
         Trigger (Coarse_Mode, Longest_Coarse);
      elsif Remaining >= Fine_Limit then
         Trigger (Coarse_Mode, Word (Remaining) / Units_Per_Coarse - Coarse_Margin);
      elsif Remaining <= 0 then
         Trigger (Fine_Mode, Shortest_Fine);
      else
         Near := (Word (Remaining) + Clock.Units_Per_Tick - 1) / Clock.Units_Per_Tick
           * Fine_Counts_Per_Tick;
         Trigger
           (Fine_Mode,
            (if Near > Early + Shortest_Fine then Near - Early else Shortest_Fine));
      end if;
   end Set;

   procedure Acknowledge is
      Discarded : Word with Volatile;
   begin
      Discarded := TC0.Status;
   end Acknowledge;

end Ravenbrick.Alarm;
