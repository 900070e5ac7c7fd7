--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body Timers is

   PMC_Peripheral_Clock_Enable : Word
     with Volatile, Import, Address => To_Address (16#FFFF_FC10#);

   TC1_And_TC2 : constant Word := 2 ** 13 + 2 ** 14;

   --  CMR: waveform mode up to RC at MCK/2, stopped by the compare or starting again
   Once   : constant Word := 16#C040#;
   Cyclic : constant Word := 16#C000#;

   Free   : constant Word := 16#8000#;

   Compare_Event      : constant Word := 2#1_0000#;
   Enable_And_Trigger : constant Word := 2#101#;

   procedure Start (Timer : in out Channel; Mode, Counts : Word) is
   begin
      PMC_Peripheral_Clock_Enable := TC1_And_TC2;
      Timer.Mode := Mode;
      Timer.Compare := Counts;
      Timer.Enable := Compare_Event;
      Timer.Control := Enable_And_Trigger;
   end Start;

   procedure Start_Once (Timer : in out Channel; Counts : Word) is
   begin
      Start (Timer, Once, Counts);
   end Start_Once;

   procedure Start_Cyclic (Timer : in out Channel; Counts : Word) is
   begin
      Start (Timer, Cyclic, Counts);
   end Start_Cyclic;

   procedure Start_Stopwatch (Timer : in out Channel) is
   begin
      PMC_Peripheral_Clock_Enable := TC1_And_TC2;
      Timer.Mode := Free;
      Timer.Control := Enable_And_Trigger;
   end Start_Stopwatch;

   procedure Acknowledge (Timer : Channel) is
      Discarded : Word with Volatile;
   begin
      Discarded := Timer.Status;
   end Acknowledge;

end Timers;
