--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;  use Ada.Real_Time;
with NXT.Bytes;      use NXT.Bytes;
with NXT.USB;

package body Results is

   Sending_Period : constant Time_Span := Milliseconds (10);

   Capacity : constant := 5_000;
   Text     : Byte_Array (1 .. Capacity);
   Written  : Natural := 0 with Atomic;
   --  Text (1 .. Written) is complete; only the task that measures adds to it.

   procedure Add (S : String) is
      Last : Natural := Written;
   begin
      for C of S loop
         exit when Last = Capacity;
         Last := Last + 1;
         Text (Last) := Character'Pos (C);
      end loop;
      Written := Last;
   end Add;

   procedure Add_Quoted (S : String) is
   begin
      Add ("""");
      Add (S);
      Add ("""");
   end Add_Quoted;

   procedure Add_Digits (Value : Natural; Width : Positive) is
      Longest : constant := 10;
      Image   : String (1 .. Longest);
      Left    : Natural := Value;
      First   : Positive := Longest + 1;
   begin
      loop
         First := First - 1;
         Image (First) := Character'Val (Character'Pos ('0') + Left mod 10);
         Left := Left / 10;
         exit when Left = 0 and then Longest - First + 1 >= Width;
      end loop;
      Add (Image (First .. Longest));
   end Add_Digits;

   procedure Begin_Row (Name : String; Value : Integer) is
   begin
      Add ("{""row"":");
      Add_Quoted (Name);
      Add (",""value"":");
      if Value < 0 then
         Add ("-");
      end if;
   end Begin_Row;

   procedure End_Row (Unit : String) is
   begin
      Add (",""unit"":");
      Add_Quoted (Unit);
      Add ("}" & ASCII.LF);
   end End_Row;

   procedure Put (Name : String; Value : Integer; Unit : String) is
   begin
      Begin_Row (Name, Value);
      Add_Digits (abs Value, Width => 1);
      End_Row (Unit);
   end Put;

   procedure Put_Thousandths (Name : String; Value : Integer; Unit : String) is
   begin
      Begin_Row (Name, Value);
      Add_Digits (abs Value / 1_000, Width => 1);
      Add (".");
      Add_Digits (abs Value mod 1_000, Width => 3);
      End_Row (Unit);
   end Put_Thousandths;

   procedure Skip (Name : String; Reason : String) is
   begin
      Add ("{""skipped"":");
      Add_Quoted (Name);
      Add (",""reason"":");
      Add_Quoted (Reason);
      Add ("}" & ASCII.LF);
   end Skip;

   procedure Finish (Part : String) is
   begin
      Add ("{""finished"":");
      Add_Quoted (Part);
      Add ("}" & ASCII.LF);
   end Finish;

   task body Sender is
      Sent   : Natural := 0;
      Asked  : NXT.USB.Packet_Data;
      Length : NXT.USB.Packet_Length;
      Last   : Natural;
      Next   : Time := Clock;
   begin
      NXT.USB.Attach;
      loop
         Next := Next + Sending_Period;
         delay until Next;
         NXT.USB.Receive (Asked, Length);
         if Length > 0 or else not NXT.USB.Configured then
            Sent := 0;
         end if;
         while Sent < Written and then NXT.USB.Packets_Free > 0 loop
            Last := Natural'Min (Written, Sent + NXT.USB.Packet_Size);
            NXT.USB.Send (Text (Sent + 1 .. Last));
            Sent := Last;
         end loop;
      end loop;
   end Sender;

begin
   Add ("{""self_test"":1}" & ASCII.LF);
end Results;
