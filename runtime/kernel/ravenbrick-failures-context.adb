--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Interfaces; use Interfaces;

with System.Storage_Elements; use System.Storage_Elements;

with Ravenbrick.Interrupts;
with Ravenbrick.Threads;

package body Ravenbrick.Failures.Context is

   use type System.Address;

   procedure Append (To : in out Line; Text : String);
   procedure Append_Number (To : in out Line; Number : Natural);
   procedure Append_Address (To : in out Line; Address : System.Address);

   function Describe_Task (Self : Threads.Thread) return Line;
   function Describe_Object (Number : Line_Number) return Line;

   procedure Append (To : in out Line; Text : String) is
   begin
      for Letter of Text loop
         exit when To.Length = Longest;
         To.Length := To.Length + 1;
         To.Text (To.Length) := Letter;
      end loop;
   end Append;

   procedure Append_Number (To : in out Line; Number : Natural) is
   begin
      if Number >= 10 then
         Append_Number (To, Number / 10);
      end if;
      Append (To, (1 => Character'Val (Character'Pos ('0') + Number mod 10)));
   end Append_Number;

   procedure Append_Address (To : in out Line; Address : System.Address) is
      Hex_Digits : constant String (1 .. 16) := "0123456789ABCDEF";
      Value      : constant Unsigned_32 := Unsigned_32 (To_Integer (Address));
   begin
      for Place in reverse 0 .. 7 loop
         Append (To, (1 => Hex_Digits (1 + Natural (Shift_Right (Value, 4 * Place) and 16#F#))));
      end loop;
   end Append_Address;

   function Describe_Task (Self : Threads.Thread) return Line is
      Name   : String (1 .. Self.Name_Length) with Import, Address => Self.Name;
      Result : Line;
   begin
      Append (Result, "task ");
      if Name'Length > 0 then
         Append (Result, Name);
      else
         Append_Address (Result, Latest.Current);
      end if;
      return Result;
   end Describe_Task;

   --  A protected object begins with its ceiling as an urgency (System.Tasking.Protected_Objects)

   function Describe_Object (Number : Line_Number) return Line is
      Ceiling : Threads.Urgency with Import, Address => Latest.Object;
      Result  : Line;
   begin
      if Latest.Object /= System.Null_Address then
         if Number = 3 then
            Append (Result, "ceiling ");
            Append_Number (Result, Natural (Ceiling) / 2);
         else
            Append (Result, "object ");
            Append_Address (Result, Latest.Object);
         end if;
      end if;
      return Result;
   end Describe_Object;

   function Describe (Number : Line_Number) return Line is
      Self   : Threads.Thread with Import, Address => Latest.Current;
      Source : constant Integer := Interrupts.Source_Of (Latest.Current);
      Result : Line;
   begin
      if Number > 2 then
         return Describe_Object (Number);
      elsif Number = 1 and then Source < 0 then
         return Describe_Task (Self);
      elsif Number = 1 then
         Append (Result, "interrupt ");
         Append_Number (Result, Source);
      elsif Source < 0 then
         Append (Result, "priority ");
         Append_Number (Result, Natural (Self.Base_Priority));
      end if;
      return Result;
   end Describe;

end Ravenbrick.Failures.Context;
