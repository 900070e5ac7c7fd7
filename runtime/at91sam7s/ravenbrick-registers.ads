--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Registers of the AT91SAM7S256 that the run-time owns. Names, offsets and bits as in the
--  datasheet (Atmel 6175): AIC section 23, PMC 26, RSTC 13, RTT 14, WDT 15,
--  PIT 16, TC 33, MC and EFC 18 and 19.

with Interfaces; use Interfaces;
with System.Storage_Elements; use System.Storage_Elements;

package Ravenbrick.Registers is
   pragma Preelaborate;

   subtype Word is Unsigned_32;

   type Source_Id is range 0 .. 31;
   --  Interrupt source: peripheral identifier

   type Source_Words is array (Source_Id) of Word;

   type Interrupt_Controller is limited record
      AIC_SMR   : Source_Words;  --  modes: level, sensitivity
      AIC_SVR   : Source_Words;  --  vectors
      AIC_SPU   : Word;          --  vector of spurious interrupts
      AIC_IECR  : Word;          --  enables sources
      AIC_IDCR  : Word;          --  disables sources
      AIC_ICCR  : Word;          --  clears pending interrupts
      AIC_EOICR : Word;          --  end of an interrupt
      AIC_DCR   : Word;          --  debug control
      AIC_FFER  : Word;          --  makes sources fast interrupts
   end record
     with Volatile;
   for Interrupt_Controller use record
      AIC_SMR   at 16#000# range 0 .. 1023;
      AIC_SVR   at 16#080# range 0 .. 1023;
      AIC_IECR  at 16#120# range 0 .. 31;
      AIC_IDCR  at 16#124# range 0 .. 31;
      AIC_ICCR  at 16#128# range 0 .. 31;
      AIC_EOICR at 16#130# range 0 .. 31;
      AIC_SPU   at 16#134# range 0 .. 31;
      AIC_DCR   at 16#138# range 0 .. 31;
      AIC_FFER  at 16#140# range 0 .. 31;
   end record;

   AIC : Interrupt_Controller with Import, Address => To_Address (16#FFFF_F000#);

   Protect_Mode : constant Word := 1;
   --  AIC_DCR, PROT: reading the vector has no effect, writing it takes the interrupt (23.8.5)

   type Power_Controller is limited record
      PMC_PCER  : Word;  --  enables clocks of peripherals
      CKGR_MOR  : Word;  --  main oscillator
      CKGR_PLLR : Word;  --  PLL
      PMC_MCKR  : Word;  --  master clock
      PMC_SR    : Word;  --  status
   end record
     with Volatile;
   for Power_Controller use record
      PMC_PCER  at 16#10# range 0 .. 31;
      CKGR_MOR  at 16#20# range 0 .. 31;
      CKGR_PLLR at 16#2C# range 0 .. 31;
      PMC_MCKR  at 16#30# range 0 .. 31;
      PMC_SR    at 16#68# range 0 .. 31;
   end record;

   PMC : Power_Controller with Import, Address => To_Address (16#FFFF_FC00#);

   --  PMC_SR
   Oscillator_Stable : constant Word := 2#0001#;  --  MOSCS
   PLL_Locked        : constant Word := 2#0100#;  --  LOCK
   Master_Ready      : constant Word := 2#1000#;  --  MCKRDY

   type Interval_Timer is limited record
      PIT_MR   : Word;  --  mode
      PIT_PIVR : Word;  --  value; reading it restarts the count of periods
      PIT_PIIR : Word;  --  periods and count, read without effect
   end record
     with Volatile;
   for Interval_Timer use record
      PIT_MR   at 16#0# range 0 .. 31;
      PIT_PIVR at 16#8# range 0 .. 31;
      PIT_PIIR at 16#C# range 0 .. 31;
   end record;

   PIT : Interval_Timer with Import, Address => To_Address (16#FFFF_FD30#);

   type Timer_Channel is limited record
      TC_CCR : Word;  --  control
      TC_CMR : Word;  --  mode
      TC_RC  : Word;  --  compare value
      TC_SR  : Word;  --  status; reading it withdraws the request
      TC_IER : Word;  --  enables interrupts
   end record
     with Volatile;
   for Timer_Channel use record
      TC_CCR at 16#00# range 0 .. 31;
      TC_CMR at 16#04# range 0 .. 31;
      TC_RC  at 16#1C# range 0 .. 31;
      TC_SR  at 16#20# range 0 .. 31;
      TC_IER at 16#24# range 0 .. 31;
   end record;

   TC0 : Timer_Channel with Import, Address => To_Address (16#FFFA_0000#);

   TC0_Id : constant Source_Id := 12;

   System_Id : constant Source_Id := 1;
   --  Shared by the timers below, the clocks' and the memory controller

   type Real_Time_Timer is limited record
      RTT_MR : Word;  --  mode
      RTT_AR : Word;  --  alarm value
   end record
     with Volatile;

   RTT : Real_Time_Timer with Import, Address => To_Address (16#FFFF_FD20#);

   RSTC_SR : Word with Import, Volatile, Address => To_Address (16#FFFF_FD04#);
   WDT_CR : Word with Import, Volatile, Address => To_Address (16#FFFF_FD40#);
   WDT_MR : Word with Import, Volatile, Address => To_Address (16#FFFF_FD44#);
   MC_FMR : Word with Import, Volatile, Address => To_Address (16#FFFF_FF60#);
   MC_RCR : Word with Import, Volatile, Address => To_Address (16#FFFF_FF00#);

end Ravenbrick.Registers;
