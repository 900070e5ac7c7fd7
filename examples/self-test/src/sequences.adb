--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Unchecked_Conversion;
with Chip;
with Interfaces;               use Interfaces;
with NXT.Registers.PMC;
with System.Storage_Elements;  use System.Storage_Elements;

package body Sequences is

   use type Word;

   Return_ARM   : constant Word := 16#E12F_FF1E#;  --  bx lr
   Return_Thumb : constant Word := 16#4770_4770#;

   --  What surrounds a sequence: delay, interrupts masked, stopwatch, call, stopwatch.
   Delays : constant := Skew'Last;
   type Frame_List is array (1 .. Delays + 15) of Word;

   Frame : Frame_List :=
     (1 .. Delays => No_Operation,
      Delays + 1  => 16#E92D_41F0#,   --  stmfd sp!, {r4-r8, lr}
      Delays + 2  => 16#E10F_4000#,   --  mrs   r4, cpsr
      Delays + 3  => 16#E384_5080#,   --  orr   r5, r4, #0x80
      Delays + 4  => 16#E121_F005#,   --  msr   cpsr_c, r5
      Delays + 5  => 16#E1A0_8000#,   --  mov   r8, r0
      Delays + 6  => 16#E598_6000#,   --  ldr   r6, [r8]
      Delays + 7  => 16#E1A0_E00F#,   --  mov   lr, pc
      Delays + 8  => 16#E12F_FF11#,   --  bx    r1
      Delays + 9  => 16#E598_7000#,   --  ldr   r7, [r8]
      Delays + 10 => 16#E121_F004#,   --  msr   cpsr_c, r4
      Delays + 11 => 16#E047_0006#,   --  sub   r0, r7, r6
      Delays + 12 => 16#E1A0_1005#,   --  mov   r1, r5
      Delays + 13 => 16#E8BD_41F0#,   --  ldmfd sp!, {r4-r8, lr}
      Delays + 14 => Return_ARM,
      Delays + 15 => No_Operation)
     with Volatile;

   type Caller is access function (Stopwatch, Place, R2, R3 : Word) return Unsigned_64
     with Convention => C;
   function To_Caller is new Ada.Unchecked_Conversion (System.Address, Caller);

   Cycles_Per_Count : constant := 2;
   Runs             : constant := 32;
   Counter_Range    : constant Word := 2 ** 16;

   Overhead : array (Instruction_Set) of Integer := (others => 0);

   Last : Natural range 0 .. Page_Words := 0;

   procedure Start_Over is
   begin
      Last := 0;
   end Start_Over;

   procedure Add (Instruction : Word; Times : Natural := 1) is
   begin
      for Count in 1 .. Times loop
         Last := Last + 1;
         Code (Last) := Instruction;
      end loop;
   end Add;

   procedure Add_Return (Set : Instruction_Set := ARM) is
   begin
      Add (if Set = ARM then Return_ARM else Return_Thumb);
   end Add_Return;

   procedure Make (Instruction : Word; Times : Positive := 1; Set : Instruction_Set := ARM) is
   begin
      Start_Over;
      Add (Instruction, Times);
      Add_Return (Set);
   end Make;

   function Run
     (Place  : System.Address;
      Set    : Instruction_Set;
      R2, R3 : Word := 0;
      Late   : Skew := 0) return Outcome
   is
      First : constant Positive := Delays + 1 - Natural (Late);
      Both  : constant Unsigned_64 :=
        To_Caller (Frame (First)'Address)
          (Word (To_Integer (Chip.Stopwatch.Value'Address)),
           Word (To_Integer (Place)) + (if Set = Thumb then 1 else 0),
           R2, R3);
      Counts : constant Word := Word (Both and 16#FFFF_FFFF#) mod Counter_Range;
   begin
      return (Counts * Cycles_Per_Count, Word (Shift_Right (Both, 32)));
   end Run;

   --  A count is the whole part of half the cycles, rounded by the phase of the stopwatch. Over
   --  all delays both phases occur equally often, so the mean is exact.
   function Mean_With_Call
     (Place : System.Address; Set : Instruction_Set; R2, R3 : Word) return Integer
   is
      Sum : Word := 0;
   begin
      for Number in 1 .. Runs loop
         Sum := Sum + Run (Place, Set, R2, R3, Skew (Number mod (Delays + 1))).Cycles;
      end loop;
      return Integer (Unsigned_64 (Sum) * 1_000 / Runs);
   end Mean_With_Call;

   function Mean
     (Place  : System.Address;
      Set    : Instruction_Set := ARM;
      R2, R3 : Word := 0) return Integer
   is (Mean_With_Call (Place, Set, R2, R3) - Overhead (Set));

   procedure Prepare is
   begin
      PMC.PMC.PMC_PCER := Bit (TC1_Id) or Bit (TC2_Id);
      Chip.Stopwatch.Mode := Chip.Free_Running;
      Chip.Stopwatch.Control := Chip.Start_Counting;
      for Set in Instruction_Set loop
         Start_Over;
         Add_Return (Set);
         Overhead (Set) := Mean_With_Call (Code'Address, Set, 0, 0);
      end loop;
   end Prepare;

end Sequences;
