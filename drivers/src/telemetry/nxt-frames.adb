--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body NXT.Frames with SPARK_Mode is

   --  CRC-16 with the polynomial 16#1021#, four bits at a time

   type Nibble is mod 16;

   Steps : constant array (Nibble) of Unsigned_16 :=
     (16#0000#, 16#1021#, 16#2042#, 16#3063#, 16#4084#, 16#50A5#, 16#60C6#, 16#70E7#,
      16#8108#, 16#9129#, 16#A14A#, 16#B16B#, 16#C18C#, 16#D1AD#, 16#E1CE#, 16#F1EF#);

   procedure Check (Value : in out Unsigned_16; Item : Byte) is
      High : constant Unsigned_16 := Shift_Right (Unsigned_16 (Item), 4);
   begin
      Value := Shift_Left (Value, 4)
        xor Steps (Nibble ((Shift_Right (Value, 12) xor High) and 15));
      Value := Shift_Left (Value, 4)
        xor Steps (Nibble ((Shift_Right (Value, 12) xor Unsigned_16 (Item)) and 15));
   end Check;

   procedure Encode (Content : Byte_Array; Line : out Byte_Array; Last : out Natural) is
      Value        : Unsigned_16 := Check_Start;
      Length_Place : Positive := Line'First;
      Place        : Positive := Line'First + 1;

      procedure Put (Item : Byte) is
      begin
         if Item = 0 then
            Line (Length_Place) := Byte (Place - Length_Place);
            Length_Place := Place;
         else
            Line (Place) := Item;
         end if;
         Place := Place + 1;
      end Put;

   begin
      for Item of Content loop
         pragma Annotate (Ravenbrick, Iterations, 120, "no content is longer");
         Check (Value, Item);
         Put (Item);
      end loop;
      Put (Byte (Value and 16#FF#));
      Put (Byte (Shift_Right (Value, 8)));
      Line (Length_Place) := Byte (Place - Length_Place);
      Line (Place) := 0;
      Last := Place;
   end Encode;

   procedure Store (This : in out Reader; Item : Byte) is
   begin
      if This.Length = This.Data'Last then
         This.Bad := True;
      else
         if This.Length >= Check_Bytes then
            Check (This.Value, This.Data (This.Length + 1 - Check_Bytes));
         end if;
         This.Length := This.Length + 1;
         This.Data (This.Length) := Item;
      end if;
   end Store;

   procedure Begin_Block (This : in out Reader; Length : Byte) is
   begin
      if This.Zero then
         Store (This, 0);
      end if;
      This.Begun := True;
      This.Left := Natural (Length) - 1;
      This.Zero := Length < Byte'Last;
   end Begin_Block;

   function Checksum_Matches (This : Reader) return Boolean is
     (not This.Bad
      and then This.Left = 0
      and then This.Length > Check_Bytes
      and then This.Data (This.Length - 1) = Byte (This.Value and 16#FF#)
      and then This.Data (This.Length) = Byte (Shift_Right (This.Value, 8)));

   procedure Finish (This : in out Reader; Complete : out Boolean) is
   begin
      Complete := Checksum_Matches (This);
      if Complete then
         This.Content := This.Length - Check_Bytes;
      elsif This.Begun then
         This.Losses := This.Losses + 1;
      end if;
      This.Value := Check_Start;
      This.Length := 0;
      This.Left := 0;
      This.Zero := False;
      This.Begun := False;
      This.Bad := False;
   end Finish;

   procedure Feed (This : in out Reader; Item : Byte; Complete : out Boolean) is
   begin
      Complete := False;
      if Item = 0 then
         Finish (This, Complete);
      elsif This.Left > 0 then
         Store (This, Item);
         This.Left := This.Left - 1;
      else
         Begin_Block (This, Item);
      end if;
   end Feed;

end NXT.Frames;
