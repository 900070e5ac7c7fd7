--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The suite's reports for a target without files: the host reads verdict and messages from
--  memory. The specification is the suite's own.

package body Report is

   type Verdict is (Running, Passed, Failing, Inapplicable, Tentative) with Size => 32;

   Present : Verdict := Running
     with Volatile;
   --  What Result will tell

   Final : Verdict := Running
     with Volatile, Export, Convention => C, External_Name => "acats_verdict";
   --  Running until Result is called; read by the host

   Log : String (1 .. 1_500) := (others => ' ')
     with Volatile, Export, Convention => C, External_Name => "acats_log";
   Log_Length : Natural := 0
     with Volatile, Export, Convention => C, External_Name => "acats_log_length";
   --  Messages one a line; what does not fit is lost

   procedure Append (Item : Character);
   procedure Note (Kind : Character; Text : String);

   procedure Append (Item : Character) is
   begin
      if Log_Length < Log'Last then
         Log_Length := Log_Length + 1;
         Log (Log_Length) := Item;
      end if;
   end Append;

   procedure Note (Kind : Character; Text : String) is
   begin
      Append (Kind);
      Append (' ');
      for Item of Text loop
         Append (Item);
      end loop;
      Append (ASCII.LF);
   end Note;

   procedure Test (Name : String; Descr : String) is
      pragma Unreferenced (Descr);
   begin
      Present := Passed;
      Note ('T', Name);
   end Test;

   procedure Failed (Descr : String) is
   begin
      Present := Failing;
      Note ('F', Descr);
   end Failed;

   procedure Not_Applicable (Descr : String) is
   begin
      if Present in Passed | Tentative then
         Present := Inapplicable;
      end if;
      Note ('N', Descr);
   end Not_Applicable;

   procedure Special_Action (Descr : String) is
   begin
      if Present = Passed then
         Present := Tentative;
      end if;
      Note ('S', Descr);
   end Special_Action;

   procedure Comment (Descr : String) is
   begin
      Note ('C', Descr);
   end Comment;

   procedure Result is
   begin
      if Present = Running then
         Note ('F', "Result before Test");
         Present := Failing;
      end if;
      Final := Present;
   end Result;

   --  The functions below hide from the compiler that they return their argument

   function Ident_Int (X : Integer) return Integer is
      Hidden : Integer := X with Volatile;
   begin
      return Hidden;
   end Ident_Int;

   function Ident_Char (X : Character) return Character is
      Hidden : Character := X with Volatile;
   begin
      return Hidden;
   end Ident_Char;

   function Ident_Wide_Char (X : Wide_Character) return Wide_Character is
      Hidden : Wide_Character := X with Volatile;
   begin
      return Hidden;
   end Ident_Wide_Char;

   function Ident_Bool (X : Boolean) return Boolean is
      Hidden : Boolean := X with Volatile;
   begin
      return Hidden;
   end Ident_Bool;

   function Ident_Str (X : String) return String is
      Hidden : String := X with Volatile;
   begin
      return Hidden;
   end Ident_Str;

   function Ident_Wide_Str (X : Wide_String) return Wide_String is
      Hidden : Wide_String := X with Volatile;
   begin
      return Hidden;
   end Ident_Wide_Str;

   function Equal (X, Y : Integer) return Boolean is (Ident_Int (X) = Ident_Int (Y));

   function Legal_File_Name (X : File_Num := 1; Nam : String := "") return String is
     ("X" & Character'Val (Character'Pos ('0') + X) & Nam);

   function Time_Stamp return String is ("no calendar");

end Report;
