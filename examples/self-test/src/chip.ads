--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Registers that the drivers do not need (AT91SAM7S datasheet, 6175M): the interrupt controller's
--  view of its sources, timer channels 1 and 2, the real-time timer, flash modes, frame number.

with NXT.Registers;  use NXT.Registers;
with System;

package Chip is

   use type Word;

   --  Interrupt controller (AIC). Protect mode is on: reading has no effect.
   AIC_Source_Mode : array (Line) of Word
     with Import, Volatile_Components, Address => System'To_Address (16#FFFF_F000#);
   Edge_Triggered  : constant Word := Bit (5);  --  SRCTYPE, internal source

   --  Timer channels: 1 is the stopwatch, 2 asks for interrupts
   type Timer_Channel is record
      Control : Word with Atomic;  --  TC_CCR
      Mode    : Word with Atomic;  --  TC_CMR
      Value   : Word with Atomic;  --  TC_CV
      Compare : Word with Atomic;  --  TC_RC
      Status  : Word with Atomic;  --  TC_SR, which reading clears
      Enable  : Word with Atomic;  --  TC_IER
      Disable : Word with Atomic;  --  TC_IDR
   end record;
   for Timer_Channel use record
      Control at 16#00# range 0 .. 31;
      Mode    at 16#04# range 0 .. 31;
      Value   at 16#10# range 0 .. 31;
      Compare at 16#1C# range 0 .. 31;
      Status  at 16#20# range 0 .. 31;
      Enable  at 16#24# range 0 .. 31;
      Disable at 16#28# range 0 .. 31;
   end record;

   Stopwatch : Timer_Channel with Import, Volatile, Address => System'To_Address (16#FFFA_0040#);
   Alarm     : Timer_Channel with Import, Volatile, Address => System'To_Address (16#FFFA_0080#);

   Free_Running    : constant Word := Bit (15);           --  WAVE, master clock divided by 2
   Start_Counting  : constant Word := Bit (0) or Bit (2); --  CLKEN, SWTRG
   Compare_Event   : constant Word := Bit (4);            --  CPCS

   --  Real-time timer (RTT), which counts the slow clock
   RTT_Mode    : Word with Import, Atomic, Address => System'To_Address (16#FFFF_FD20#);
   RTT_Value   : Word with Import, Atomic, Address => System'To_Address (16#FFFF_FD28#);
   RTT_Restart : constant Word := Bit (18);

   --  Flash mode: wait states, and cycles in 1.5 us for programming
   MC_FMR : Word with Import, Atomic, Address => System'To_Address (16#FFFF_FF60#);
   Wait_State_Place : constant := 2 ** 8;

   --  Glitch filters of the pins
   PIO_Filter_Off    : Word with Import, Atomic, Address => System'To_Address (16#FFFF_F424#);
   PIO_Interrupt_Off : Word with Import, Atomic, Address => System'To_Address (16#FFFF_F444#);

   --  Number of the USB frame, modulo 2,048; one frame lasts a millisecond of the host's clock
   UDP_Frame : Word with Import, Atomic, Address => System'To_Address (16#FFFB_0000#);

   --  Status of the converter: a bit for each channel, up when its conversion has ended
   ADC_Status : Word with Import, Atomic, Address => System'To_Address (16#FFFD_801C#);

end Chip;
