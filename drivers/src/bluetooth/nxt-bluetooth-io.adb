--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

separate (NXT.Bluetooth)
package body IO is

   --  A message travels as on all links of the brick: its length in two bytes, the lower one
   --  first, and its bytes.

   Header_Length : constant := 2;
   Bits_Per_Byte : constant := 8;

   function Length_Of (Item : Message) return Natural is
     ((Item'Size + Bits_Per_Byte - 1) / Bits_Per_Byte);

   procedure Send_All (Data : Byte_Array) is
      First : Positive := Data'First;
      Last  : Natural;
      Next  : Time := Clock;
   begin
      while First <= Data'Last and then Current_State = Connected loop
         Last := Natural'Min (Data'Last, First + Room - 1);
         Send (Data (First .. Last));
         First := Last + 1;
         exit when First > Data'Last;
         Next := Next + Poll_Period;
         delay until Next;
         Poll;
      end loop;
   end Send_All;

   --  All of Data, or nothing more once the connection has ended.
   procedure Receive_All (Data : out Byte_Array; Complete : out Boolean) is
      First : Positive := Data'First;
      Last  : Natural;
      Next  : Time := Clock;
   begin
      loop
         Receive (Data (First .. Data'Last), Last);
         First := Last + 1;
         Complete := First > Data'Last;
         exit when Complete or else Current_State /= Connected;
         Next := Next + Poll_Period;
         delay until Next;
         Poll;
      end loop;
   end Receive_All;

   procedure Send (This : access Message) is
      Length : constant Natural := Length_Of (This.all);
      Data   : Byte_Array (1 .. Length) with Import, Address => This.all'Address;
   begin
      Send_All (To_Bytes (Unsigned_16 (Length)));
      Send_All (Data);
   end Send;

   procedure Skip (Length : Natural; Complete : out Boolean) is
      Skipped : Byte_Array (1 .. 1);
   begin
      Complete := True;
      for Count in 1 .. Length loop
         Receive_All (Skipped, Complete);
         exit when not Complete;
      end loop;
   end Skip;

   procedure Receive (This : access Message) is
      Length    : constant Natural := Length_Of (This.all);
      Data      : Byte_Array (1 .. Length) with Import, Address => This.all'Address;
      Header    : Byte_Array (1 .. Header_Length);
      Announced : Natural;
      Complete  : Boolean;
   begin
      loop
         Receive_All (Header, Complete);
         exit when not Complete;
         Announced := Natural (Header (1)) + 256 * Natural (Header (2));
         if Announced = Length then
            Receive_All (Data, Complete);
            exit;
         end if;
         Skip (Announced, Complete);
         exit when not Complete;
      end loop;
   end Receive;

end IO;
