--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Interfaces;       use Interfaces;
with NXT.Flash_Pages;  use NXT.Flash_Pages;
with System;

package body NXT.Parameters is

   First_Page : constant Page_Id := 992;
   subtype Ring_Page is Page_Id range First_Page .. Page_Id'Last;

   --  Pages tried in one saving
   Attempts : constant := 3;

   Magic : constant Unsigned_32 := 16#5250_4252#;

   type Byte_Array is array (Positive range <>) of Unsigned_8;
   subtype Data_Bytes is Byte_Array (1 .. Maximum_Bytes);
   subtype Data_Length is Natural range 0 .. Maximum_Bytes;

   type Record_Page is record
      Magic    : Unsigned_32;
      Sequence : Unsigned_32;
      Id       : Unsigned_8;
      Length   : Unsigned_8;
      Format   : Unsigned_16;
      Check    : Unsigned_32;
      Data     : Data_Bytes;
   end record with Size => 2_048;
   --  Check: over all other components.

   subtype Found_Page is Natural;
   No_Page : constant Found_Page := 0;

   Current       : array (Parameter_Id) of Found_Page := (others => No_Page);
   Last_Page     : Ring_Page := Ring_Page'Last;
   Last_Sequence : Unsigned_32 := 0;

   --  The four-bit remainders of CRC-32 (ISO 3309), least significant bit first.
   Remainders : constant array (Unsigned_32 range 0 .. 15) of Unsigned_32 :=
     (16#0000_0000#, 16#1DB7_1064#, 16#3B6E_20C8#, 16#26D9_30AC#,
      16#76DC_4190#, 16#6B6B_51F4#, 16#4DB2_6158#, 16#5005_713C#,
      16#EDB8_8320#, 16#F00F_9344#, 16#D6D6_A3E8#, 16#CB61_B38C#,
      16#9B64_C2B0#, 16#86D3_D2D4#, 16#A00A_E278#, 16#BDBD_F21C#);

   function Checksum_Of (Page : Record_Page) return Unsigned_32 is
      Checked : Record_Page := Page;
      Bytes   : Byte_Array (1 .. 256) with Import, Address => Checked'Address;
      Sum     : Unsigned_32 := 16#FFFF_FFFF#;
   begin
      Checked.Check := 0;
      for Byte of Bytes loop
         Sum := Sum xor Unsigned_32 (Byte);
         Sum := Shift_Right (Sum, 4) xor Remainders (Sum and 15);
         Sum := Shift_Right (Sum, 4) xor Remainders (Sum and 15);
      end loop;
      return not Sum;
   end Checksum_Of;

   function Read (Page : Ring_Page) return Record_Page is
      Words  : constant Page_Content := Content (Page);
      Result : Record_Page with Import, Address => Words'Address;
   begin
      return Result;
   end Read;

   function Is_Valid (Page : Record_Page) return Boolean is
     (Page.Magic = Magic and then Page.Check = Checksum_Of (Page)
      and then Page.Id in Unsigned_8 (Parameter_Id'First) .. Unsigned_8 (Parameter_Id'Last)
      and then Page.Length <= Maximum_Bytes);

   procedure Find_Current is
      Newest : array (Parameter_Id) of Unsigned_32 := (others => 0);
      Page   : Record_Page;
   begin
      for Number in Ring_Page loop
         Page := Read (Number);
         if Is_Valid (Page) then
            if Page.Sequence > Newest (Parameter_Id (Page.Id)) then
               Newest (Parameter_Id (Page.Id)) := Page.Sequence;
               Current (Parameter_Id (Page.Id)) := Number;
            end if;
            if Page.Sequence > Last_Sequence then
               Last_Sequence := Page.Sequence;
               Last_Page := Number;
            end if;
         end if;
      end loop;
   end Find_Current;

   function Is_Current (Page : Ring_Page) return Boolean is
     (for some Number of Current => Number = Page);

   function After (Page : Ring_Page) return Ring_Page is
     (if Page = Ring_Page'Last then Ring_Page'First else Page + 1);

   --  The next page of the ring that can be overwritten. There are more pages than values.
   function Next_Free (Page : Ring_Page) return Ring_Page is
   begin
      return Next : Ring_Page := After (Page) do
         while Is_Current (Next) loop
            Next := After (Next);
         end loop;
      end return;
   end Next_Free;

   function Holds
     (Id : Parameter_Id; Format : Format_Number; Length : Data_Length) return Boolean is
   begin
      if Current (Id) = No_Page then
         return False;
      end if;
      declare
         Page : constant Record_Page := Read (Current (Id));
      begin
         return Page.Format = Unsigned_16 (Format) and then Natural (Page.Length) = Length;
      end;
   end Holds;

   procedure Save
     (Id     : Parameter_Id;
      Format : Format_Number;
      Data   : Byte_Array;
      Result : out Save_Result)
   is
      Page  : Record_Page :=
        (Magic, Last_Sequence + 1, Unsigned_8 (Id), Data'Length, Unsigned_16 (Format), 0,
         (others => 0));
      Words : Page_Content with Import, Address => Page'Address;
      Done  : Boolean;
   begin
      Page.Data (1 .. Data'Length) := Data;
      Page.Check := Checksum_Of (Page);
      Result := Memory_Failed;
      for Attempt in 1 .. Attempts loop
         Last_Page := Next_Free (Last_Page);
         Program (Last_Page, Words, Done);
         if Done then
            Current (Id) := Last_Page;
            Last_Sequence := Page.Sequence;
            Result := Saved;
            exit;
         end if;
      end loop;
   end Save;

   package body Store is

      Length : constant Data_Length := Value'Object_Size / System.Storage_Unit;

      procedure Load (Item : in out Value; Found : out Boolean) is
         Bytes : Byte_Array (1 .. Length) with Import, Address => Item'Address;
      begin
         Found := Holds (Id, Format, Length);
         if Found then
            Bytes := Read (Current (Id)).Data (1 .. Length);
         end if;
      end Load;

      procedure Save (Item : Value; Result : out Save_Result) is
         Bytes : Byte_Array (1 .. Length) with Import, Address => Item'Address;
      begin
         if Holds (Id, Format, Length)
           and then Read (Current (Id)).Data (1 .. Length) = Bytes
         then
            Result := Saved;
         else
            Save (Id, Format, Bytes, Result);
         end if;
      end Save;

   end Store;

begin
   Find_Current;
end NXT.Parameters;
