--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with System.Storage_Elements; use System.Storage_Elements;

with Ravenbrick.Registers; use Ravenbrick.Registers;

package body Ravenbrick.Board is

   use type Word;

   One_Wait_State_72_Cycles : constant Word := 16#0048_0100#;
   --  FMR: flash above 30 MHz needs FWS = 1; FMCN is the number of cycles in 1.5 us

   Watchdog_Setting : Word with
     Import, Convention => C, External_Name => "ravenbrick_watchdog_mode";
   --  WDT_MR: the address of this symbol, which the linker script sets

   Enable_Main_Oscillator : constant Word := 16#0601#;
   --  MOR: start-up time of 6 * 8 slow clocks

   PLL_73_By_14 : constant Word := 16#1048_1C0E#;
   --  PLLR: 18.432 MHz * 73 / 14 = 96.11 MHz after 28 slow clocks; USB clock is half of it

   Half         : constant Word := 2#00100#;
   PLL_Selected : constant Word := 2#00011#;
   --  MCKR: prescaler and source

   Remap : constant Word := 1;

   Low_Word : Word with Import, Volatile, Address => To_Address (16#0000_2000#);
   RAM_Word : Word with Import, Volatile, Address => To_Address (16#0020_2000#);

   procedure Await (Flag : Word);
   procedure Start_Clocks;
   procedure Show_RAM_At_Zero;

   procedure Await (Flag : Word) is
   begin
      while (PMC.PMC_SR and Flag) = 0 loop
         null;
      end loop;
   end Await;

   procedure Start_Clocks is
   begin
      PMC.CKGR_MOR := Enable_Main_Oscillator;
      Await (Oscillator_Stable);
      PMC.CKGR_PLLR := PLL_73_By_14;
      Await (PLL_Locked);
      PMC.PMC_MCKR := Half;
      Await (Master_Ready);
      PMC.PMC_MCKR := Half or PLL_Selected;
      Await (Master_Ready);
   end Start_Clocks;

   --  The remap command toggles and its state cannot be read: see whether address 0 follows a
   --  change of the RAM

   procedure Show_RAM_At_Zero is
      Original : constant Word := RAM_Word;
      Before   : constant Word := Low_Word;
      After    : Word;
   begin
      RAM_Word := not Original;
      After := Low_Word;
      RAM_Word := Original;
      if After = Before then
         MC_RCR := Remap;
      end if;
   end Show_RAM_At_Zero;

   procedure Start is
   begin
      MC_FMR := One_Wait_State_72_Cycles;
      WDT_MR := Word (To_Integer (Watchdog_Setting'Address));
      if (PMC.PMC_MCKR and PLL_Selected) /= PLL_Selected then
         Start_Clocks;
      end if;
      Show_RAM_At_Zero;
   end Start;

end Ravenbrick.Board;
