--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;            use Ada.Real_Time;
with Chip;
with Link_Timing;
with NXT.Registers;            use NXT.Registers;
with NXT.Registers.EFC;
with Results;
with Sequences;                use Sequences;
with System;
with System.Storage_Elements;  use System.Storage_Elements;

package body Memory_Timing is

   use type Word;

   Cycles : constant String := "cycles";

   Repeats : constant := 60;
   --  Instructions in a sequence

   Data : aliased Word_List with Volatile;
   --  Words to load, in RAM

   Harmless_Register : constant Word := 16#FFFF_F444#;
   --  PIO_IDR: zeros written to it, and reading it, have no effect.

   Large_Factor : constant Word := 16#7654_3210#;

   --  The last page before those of NXT.Parameters
   Page         : constant := 991;
   Page_Address : constant System.Address :=
     To_Address (Integer_Address (EFC.Start_Address + Page * EFC.Page_Length));

   Flash_Page : Word_List with Import, Volatile, Address => Page_Address;

   function Address_Word (Place : System.Address) return Word is (Word (To_Integer (Place)));

   procedure Put_Mean
     (Name  : String;
      Place : System.Address;
      Set   : Instruction_Set := ARM;
      R2, R3 : Word := 0) is
   begin
      Link_Timing.Await_Quiet;
      Results.Put_Thousandths (Name, Mean (Place, Set, R2, R3), Cycles);
   end Put_Mean;

   procedure Put_Made
     (Name        : String;
      Instruction : Word;
      Set         : Instruction_Set := ARM;
      R2, R3      : Word := 0) is
   begin
      Make (Instruction, Repeats, Set);
      Put_Mean (Name, Code'Address, Set, R2, R3);
   end Put_Made;

   procedure Measure_RAM is
   begin
      Put_Made ("ram.arm_operations", No_Operation);
      Put_Made ("ram.thumb_operations", Thumb_No_Operations, Thumb);
      Put_Made ("ram.loads", Load, R2 => Address_Word (Data'Address));
      Put_Made ("ram.stores", Store, R2 => Address_Word (Data'Address));
      Put_Made ("ram.multiple_loads", Load_Four);
      Put_Made ("ram.multiplications", Multiply, R2 => Large_Factor, R3 => Large_Factor);
      Put_Made ("ram.branches", Branch_Over_One);
      Put_Made ("peripheral.loads", Load, R2 => Harmless_Register);
      Put_Made ("peripheral.stores", Store, R2 => Harmless_Register);
      Put_Made ("flash.loads", Load, R2 => Address_Word (Page_Address));
   end Measure_RAM;

   --  Programming

   Programming_Failed : Boolean := False;
   Longest            : Time_Span := Time_Span_Zero;

   procedure Await_Ready is
   begin
      while not Has (EFC.EFC.MC_FSR, EFC.Ready) loop
         null;
      end loop;
   end Await_Ready;

   procedure Program (Content : Word_List) is
      Start : Time;
   begin
      if Has (EFC.EFC.MC_FSR, Bit (EFC.First_Lock + Page / EFC.Region_Pages)) then
         EFC.EFC.MC_FCR := EFC.Clear_Lock or Page * 2 ** EFC.Page_Place;
         Await_Ready;
      end if;
      for Number in Content'Range loop
         Flash_Page (Number) := Content (Number);
      end loop;
      Start := Clock;
      EFC.EFC.MC_FCR := EFC.Write_Page or Page * 2 ** EFC.Page_Place;
      Await_Ready;
      if Clock - Start > Longest then
         Longest := Clock - Start;
      end if;
      for Number in Content'Range loop
         Programming_Failed := Programming_Failed or else Flash_Page (Number) /= Content (Number);
      end loop;
   end Program;

   procedure Put_In_Flash
     (Name        : String;
      Instruction : Word;
      Set         : Instruction_Set := ARM)
   is
      Made : Word_List;
   begin
      Make (Instruction, Repeats, Set);
      Made := Code;
      Program (Made);
      Put_Mean ("flash." & Name, Page_Address, Set, Address_Word (Data'Address));
   end Put_In_Flash;

   --  The same page with one more wait state
   procedure Put_With_More_Wait_States (Name : String) is
      Mode : constant Word := Chip.MC_FMR;
   begin
      Chip.MC_FMR := Mode + Chip.Wait_State_Place;
      Put_Mean (Name, Page_Address, ARM);
      Chip.MC_FMR := Mode;
   end Put_With_More_Wait_States;

   procedure Measure_Flash is
      Before : constant Word_List := Flash_Page;
   begin
      Put_In_Flash ("arm_operations", No_Operation);
      Put_With_More_Wait_States ("flash.arm_operations_slower");
      Put_In_Flash ("arm_branches", Branch_Over_One);
      Put_In_Flash ("thumb_operations", Thumb_No_Operations, Thumb);
      Put_In_Flash ("thumb_branches_even", Thumb_Even_Branch, Thumb);
      Put_In_Flash ("thumb_branches_odd", Thumb_Odd_Branch, Thumb);
      Put_In_Flash ("thumb_with_ram_loads", Thumb_Loads, Thumb);
      Put_Mean ("flash.thumb_with_flash_loads", Page_Address, Thumb, Address_Word (Page_Address));
      Program (Before);
      if Programming_Failed then
         Results.Skip ("flash.page", "a page could not be programmed or restored");
      else
         Results.Put ("flash.page", Longest * 1_000 / Milliseconds (1), "us");
      end if;
   end Measure_Flash;

end Memory_Timing;
