--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Registers of the AT91SAM7S256 that the run-time owns. Names, offsets and bits as in the
--  datasheet (Atmel 6175): AIC section 23, PMC 26, PIT 16, TC 33, MC and EFC 18 and 19.

with Interfaces; use Interfaces;
with System.Storage_Elements; use System.Storage_Elements;

package Ravenbrick.Registers is
   pragma Preelaborate;

   subtype Word is Unsigned_32;

   type Source_Id is range 0 .. 31;
   --  Interrupt source: peripheral identifier

   type Source_Set is array (Source_Id) of Boolean with Pack, Size => 32;

   type Source_Words is array (Source_Id) of Word;

   type Interrupt_Controller is limited record
      Source_Mode   : Source_Words;  --  SMR: level, sensitivity
      Source_Vector : Source_Words;  --  SVR
      Spurious      : Word;          --  SPU
      Enable        : Word;          --  IECR
      Disable       : Word;          --  IDCR
      Clear         : Word;          --  ICCR
      End_Of        : Word;          --  EOICR
      Control       : Word;          --  DCR
   end record
     with Volatile;
   for Interrupt_Controller use record
      Source_Mode   at 16#000# range 0 .. 1023;
      Source_Vector at 16#080# range 0 .. 1023;
      Enable        at 16#120# range 0 .. 31;
      Disable       at 16#124# range 0 .. 31;
      Clear         at 16#128# range 0 .. 31;
      End_Of        at 16#130# range 0 .. 31;
      Spurious      at 16#134# range 0 .. 31;
      Control       at 16#138# range 0 .. 31;
   end record;

   AIC : Interrupt_Controller with Import, Address => To_Address (16#FFFF_F000#);

   Protect_Mode : constant Word := 1;
   --  DCR: reading the vector has no effect, writing it takes the interrupt (23.8.5)

   type Power_Controller is limited record
      System_Clock_Disable     : Word;  --  SCDR
      Peripheral_Clock_Enable  : Word;  --  PCER
      Main_Oscillator          : Word;  --  MOR
      PLL                      : Word;  --  PLLR
      Master_Clock             : Word;  --  MCKR
      Status                   : Word;  --  SR
   end record
     with Volatile;
   for Power_Controller use record
      System_Clock_Disable     at 16#04# range 0 .. 31;
      Peripheral_Clock_Enable  at 16#10# range 0 .. 31;
      Main_Oscillator          at 16#20# range 0 .. 31;
      PLL                      at 16#2C# range 0 .. 31;
      Master_Clock             at 16#30# range 0 .. 31;
      Status                   at 16#68# range 0 .. 31;
   end record;

   PMC : Power_Controller with Import, Address => To_Address (16#FFFF_FC00#);

   Oscillator_Stable : constant Word := 2#0001#;
   PLL_Locked        : constant Word := 2#0100#;
   Master_Ready      : constant Word := 2#1000#;

   type Interval_Timer is limited record
      Mode        : Word;  --  MR
      Value_Clear : Word;  --  PIVR: reading it restarts the count of periods
      Image       : Word;  --  PIIR: periods and count, read without effect
   end record
     with Volatile;
   for Interval_Timer use record
      Mode        at 16#0# range 0 .. 31;
      Value_Clear at 16#8# range 0 .. 31;
      Image       at 16#C# range 0 .. 31;
   end record;

   PIT : Interval_Timer with Import, Address => To_Address (16#FFFF_FD30#);

   type Timer_Channel is limited record
      Control   : Word;  --  CCR
      Mode      : Word;  --  CMR
      Compare   : Word;  --  RC
      Status    : Word;  --  SR: reading it withdraws the request
      Enable    : Word;  --  IER
   end record
     with Volatile;
   for Timer_Channel use record
      Control   at 16#00# range 0 .. 31;
      Mode      at 16#04# range 0 .. 31;
      Compare   at 16#1C# range 0 .. 31;
      Status    at 16#20# range 0 .. 31;
      Enable    at 16#24# range 0 .. 31;
   end record;

   TC0 : Timer_Channel with Import, Address => To_Address (16#FFFA_0000#);

   TC0_Id : constant Source_Id := 12;

   Watchdog_Mode : Word with Import, Volatile, Address => To_Address (16#FFFF_FD44#);
   Flash_Mode    : Word with Import, Volatile, Address => To_Address (16#FFFF_FF60#);
   Remap_Control : Word with Import, Volatile, Address => To_Address (16#FFFF_FF00#);

end Ravenbrick.Registers;
