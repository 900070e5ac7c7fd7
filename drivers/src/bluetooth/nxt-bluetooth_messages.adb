--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Interfaces;  use Interfaces;
with NXT.Bluetooth_Line;

package body NXT.Bluetooth_Messages is

   procedure Send (Code : Byte; Arguments : Byte_Array := No_Arguments) is
      Sum   : Unsigned_16 := Unsigned_16 (Code);
      Frame : Byte_Array (1 .. Longest_Message);
      Last  : constant Positive := 1 + Overhead + Arguments'Length;
   begin
      Frame (1) := Byte (Last - 1);
      Frame (2) := Code;
      for Index in 1 .. Arguments'Length loop
         pragma Annotate (Ravenbrick, Iterations, 40, "Longest_Arguments");
         Frame (2 + Index) := Arguments (Arguments'First + Index - 1);
         Sum := Sum + Unsigned_16 (Frame (2 + Index));
      end loop;
      Sum := -Sum;
      Frame (Last - 1) := Byte (Shift_Right (Sum, 8));
      Frame (Last) := Byte (Sum and 16#FF#);
      if Bluetooth_Line.Room >= Last then
         Bluetooth_Line.Send (Frame (1 .. Last));
      end if;
   end Send;

   --  What has come of a message; Sum is of all bytes so far, the check's two as one number.

   Coming : Message;
   Length : Natural := 0;
   Taken  : Natural := 0;
   Sum    : Unsigned_16 := 0;

   procedure Restart is
   begin
      Length := 0;
      Taken := 0;
   end Restart;

   procedure Keep_Argument (Item : Byte) is
   begin
      if Coming.Count < Longest_Arguments then
         Coming.Count := Coming.Count + 1;
         Coming.Arguments (Coming.Count) := Item;
      end if;
   end Keep_Argument;

   --  A length too short for a message is passed over: the next byte may be one.
   procedure Accept_Length (Item : Byte) is
   begin
      if Item >= Overhead then
         Length := Natural (Item);
         Taken := 0;
         Sum := Unsigned_16 (Item);
         Coming.Count := 0;
      end if;
   end Accept_Length;

   procedure Accept_Byte (Item : Byte; Complete : out Boolean) is
   begin
      Complete := False;
      if Length = 0 then
         Accept_Length (Item);
         return;
      end if;
      Taken := Taken + 1;
      if Taken = Length - 1 then
         Sum := Sum + Shift_Left (Unsigned_16 (Item), 8);
      else
         Sum := Sum + Unsigned_16 (Item);
      end if;
      if Taken = 1 then
         Coming.Code := Item;
      elsif Taken <= Length - Check_Length then
         Keep_Argument (Item);
      elsif Taken = Length then
         Complete := Sum = 0 and then Length - Overhead <= Longest_Arguments;
         Restart;
      end if;
   end Accept_Byte;

   procedure Receive (Item : out Message; Found : out Boolean) is
      Most_Bytes : constant := 16;

      Next  : Byte;
      Comes : Boolean;
   begin
      Found := False;
      for Count in 1 .. Most_Bytes loop
         Bluetooth_Line.Receive (Next, Comes);
         exit when not Comes;
         Accept_Byte (Next, Found);
         exit when Found;
      end loop;
      Item := Coming;
   end Receive;

end NXT.Bluetooth_Messages;
