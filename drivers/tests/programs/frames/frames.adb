--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Frames in and out: results in symbols for an observer.

with Interfaces;  use Interfaces;
with NXT.Bytes;   use NXT.Bytes;
with NXT.Frames;

procedure Frames is

   Lengths : constant array (1 .. 5) of Positive := (1, 5, 30, 90, 120);
   --  Contents are made of a generator that often gives zero.

   Line  : Byte_Array (1 .. 400) := (others => 0) with
     Volatile, Export, Convention => C, External_Name => "line";
   Used  : Integer := 0 with Volatile, Export, Convention => C, External_Name => "line_length";
   Whole : Integer := 0 with Volatile, Export, Convention => C, External_Name => "whole_frames";
   Equal : Integer := 0 with Volatile, Export, Convention => C, External_Name => "equal_frames";
   Lost  : Integer := 0 with Volatile, Export, Convention => C, External_Name => "damaged_frames";

   State : Unsigned_32 := 1;

   function Next return Byte is
      Item : Unsigned_32;
   begin
      State := State * 1_664_525 + 1_013_904_223;
      Item := Shift_Right (State, 24);
      return (if Item < 64 then 0 else Byte (Item));
   end Next;

   Sent    : Byte_Array (1 .. 120);
   Reader  : NXT.Frames.Reader;

   procedure Compare (Length : Positive) is
   begin
      Whole := Whole + 1;
      if NXT.Frames.Content_Length (Reader) = Length
        and then (for all Index in 1 .. Length =>
                    NXT.Frames.Content_Byte (Reader, Index) = Sent (Index))
      then
         Equal := Equal + 1;
      end if;
   end Compare;

   type Fate is (Kept, Spoilt, Unrecorded);

   procedure Send (Length : Positive; Now : Fate) is
      Frame    : Byte_Array (1 .. NXT.Frames.Longest_Frame);
      Last     : Natural;
      Complete : Boolean;
   begin
      for Item of Sent (1 .. Length) loop
         Item := Next;
      end loop;
      NXT.Frames.Encode (Sent (1 .. Length), Frame, Last);
      if Now = Spoilt then
         Frame (Last / 2) := Frame (Last / 2) xor 16#80#;
      elsif Now = Kept then
         Line (Used + 1 .. Used + Last) := Frame (1 .. Last);
         Used := Used + Last;
      end if;
      for Item of Frame (1 .. Last) loop
         NXT.Frames.Feed (Reader, Item, Complete);
         if Complete then
            Compare (Length);
         end if;
      end loop;
   end Send;

begin
   for Length of Lengths loop
      Send (Length, Kept);
   end loop;
   for Length of Lengths loop
      Send (Length, Spoilt);
   end loop;
   Lost := NXT.Frames.Damaged (Reader);
   for Count in 1 .. 300 loop
      declare
         Complete : Boolean;
      begin
         NXT.Frames.Feed (Reader, 16#55#, Complete);
      end;
   end loop;
   Send (40, Unrecorded);
end Frames;
