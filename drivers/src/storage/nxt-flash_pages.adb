--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;
with NXT.Registers.EFC;        use NXT.Registers, NXT.Registers.EFC;
with System.Storage_Elements;  use System.Storage_Elements;

package body NXT.Flash_Pages is

   use Ada.Real_Time;
   use type Word;

   Controller : Registers.EFC.Peripheral renames Registers.EFC.EFC;

   --  A page with erasing takes 6 ms, a lock or general purpose bit 3 ms (datasheet, flash
   --  characteristics)
   Page_Time : constant Time_Span := Milliseconds (7);
   Lock_Time : constant Time_Span := Milliseconds (4);

   RAM_Start : constant := 16#0020_0000#;

   procedure Command_And_Wait (Command : Word) with
     No_Inline, Linker_Section => ".code_in_ram";
   --  Must not use what lies in flash.

   procedure Command_And_Wait (Command : Word) is
   begin
      Controller.MC_FCR := Command;
      while (Controller.MC_FSR and Ready) = 0 loop
         null;
      end loop;
   end Command_And_Wait;

   protected Masked with Interrupt_Priority => System.Interrupt_Priority'Last is
      procedure Perform (Command : Word);
   end Masked;

   protected body Masked is

      procedure Perform (Command : Word) is
      begin
         Command_And_Wait (Command);
      end Perform;

   end Masked;

   function Address_Of (Page : Page_Id) return System.Address is
     (To_Address (Integer_Address (Start_Address + Page_Length * Page)));

   function Content (Page : Page_Id) return Page_Content is
      Words : Page_Content with Import, Volatile, Address => Address_Of (Page);
   begin
      return Words;
   end Content;

   procedure Perform (Command : Word; Span : Time_Span) is
   begin
      if To_Integer (Content'Code_Address) >= RAM_Start then
         Controller.MC_FCR := Command;
         delay until Clock + Span;
      else
         Masked.Perform (Command);
      end if;
   end Perform;

   function Region_Is_Locked (Page : Page_Id) return Boolean is
     (Has (Controller.MC_FSR, Bit (First_Lock + Page / Region_Pages)));

   procedure Program (Page : Page_Id; Content : Page_Content; Done : out Boolean) is
      Latch : Page_Content with Import, Volatile, Address => Address_Of (Page);
      Place : constant Word := Word (Page) * 2 ** Page_Place;
   begin
      if Region_Is_Locked (Page) then
         Perform (Clear_Lock or Place, Lock_Time);
      end if;
      for Number in Latch'Range loop
         Latch (Number) := Content (Number);
      end loop;
      Perform (Write_Page or Place, Page_Time);
      Done := Flash_Pages.Content (Page) = Content;
   end Program;

   function Bit_Is_Set (Number : Bit_Id) return Boolean is
     (Has (Controller.MC_FSR, Bit (First_Bit + Number)));

   procedure Set_Bit (Number : Bit_Id) is
   begin
      if not Bit_Is_Set (Number) then
         Perform (Registers.EFC.Set_Bit or Word (Number) * 2 ** Page_Place, Lock_Time);
      end if;
   end Set_Bit;

end NXT.Flash_Pages;
