--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Short instruction sequences, made at run time and timed with interrupts masked. They lie in RAM
--  or are copied to a page of the flash, so that the costs of both memories can be compared.
--
--  A sequence may use r0, r5, r7 and r12. r2 and r3 hold its arguments, r4 the caller's status, r6
--  the stopwatch at the beginning. It ends with a return; its result is what it leaves in r5.

with NXT.Registers;  use NXT.Registers;
with System;

package Sequences is

   --  ARM instructions (ARM DDI 0029E, chapter 4)
   No_Operation    : constant Word := 16#E1A0_0000#;  --  mov   r0, r0
   Load            : constant Word := 16#E592_0000#;  --  ldr   r0, [r2]
   Store           : constant Word := 16#E582_3000#;  --  str   r3, [r2]
   Store_Next      : constant Word := 16#E582_3004#;  --  str   r3, [r2, #4]
   Load_Four       : constant Word := 16#E89D_10A1#;  --  ldmia sp, {r0, r5, r7, r12}
   Multiply        : constant Word := 16#E000_0392#;  --  mul   r0, r2, r3
   Branch_Over_One : constant Word := 16#EA00_0000#;  --  b     . + 8
   Unmask          : constant Word := 16#E121_F004#;  --  msr   cpsr_c, r4
   Zero_R12        : constant Word := 16#E3A0_C000#;  --  mov   r12, #0
   Load_Request    : constant Word := 16#E51C_5EEC#;  --  ldr   r5, [r12, #-0xEEC], AIC_CISR
   Load_Pin_Edges  : constant Word := 16#E592_001C#;  --  ldr   r0, [r2, #0x1C]
   Keep_Start      : constant Word := 16#E1A0_5006#;  --  mov   r5, r6
   Load_Count      : constant Word := 16#E3A0_0C17#;  --  mov   r0, #0x1700
   Count_Down      : constant Word := 16#E250_0001#;  --  subs  r0, r0, #1
   Loop_To_Count   : constant Word := 16#1AFF_FFFD#;  --  bne   . - 4

   Interrupt_Requested : constant Word := Bit (1);
   --  What Load_Request reads while the interrupt controller asks the processor to interrupt.

   --  Pairs of Thumb instructions (chapter 5); the first is in the lower half
   Thumb_No_Operations : constant Word := 16#46C0_46C0#;  --  mov r8, r8; mov r8, r8
   Thumb_Loads         : constant Word := 16#6810_6810#;  --  ldr r0, [r2]; ldr r0, [r2]
   Thumb_Even_Branch   : constant Word := 16#46C0_E000#;  --  b . + 4; mov r8, r8
   Thumb_Odd_Branch    : constant Word := 16#E000_46C0#;  --  mov r8, r8; b . + 4

   type Instruction_Set is (ARM, Thumb);

   Page_Words : constant := 64;
   type Word_List is array (1 .. Page_Words) of Word;

   Code : aliased Word_List := (others => No_Operation) with Volatile;
   --  The sequence being made, in RAM.

   procedure Make (Instruction : Word; Times : Positive := 1; Set : Instruction_Set := ARM);
   --  Replace the sequence by Times instructions and a return.

   procedure Start_Over;
   procedure Add (Instruction : Word; Times : Natural := 1);
   procedure Add_Return (Set : Instruction_Set := ARM);
   --  Make a sequence of several kinds of instruction.

   type Outcome is record
      Cycles : Word;
      Result : Word;
   end record;
   --  Cycles: from stamp to stamp, to the precision of the stopwatch of 2 cycles.

   type Skew is range 0 .. 7;
   --  Cycles that a run begins later, which moves it against the clock of the stopwatch.

   function Run
     (Place  : System.Address;
      Set    : Instruction_Set;
      R2, R3 : Word := 0;
      Late   : Skew := 0) return Outcome;

   function Mean
     (Place  : System.Address;
      Set    : Instruction_Set := ARM;
      R2, R3 : Word := 0) return Integer;
   --  Cycles of a sequence without call and return, in thousandths: the mean of 32 runs, in which
   --  each phase of the stopwatch occurs equally often.

   procedure Prepare;
   --  Start the stopwatch and measure what call and return cost.

end Sequences;
