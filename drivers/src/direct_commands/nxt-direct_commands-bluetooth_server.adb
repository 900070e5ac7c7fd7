--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;  use Ada.Real_Time;
with Interfaces;     use Interfaces;
with NXT.Bluetooth;

package body NXT.Direct_Commands.Bluetooth_Server is

   Header_Length : constant := 2;
   Retry_Period  : constant Time_Span := Seconds (1);

   task Server_Task with Priority => Priority, Storage_Size => Stack_Bytes;

   --  What has come of a telegram, its length included.

   Incoming      : Byte_Array (1 .. Header_Length + Longest_Telegram);
   Received      : Natural := 0;
   Skipped_Bytes : Natural := 0;
   --  Skipped_Bytes: bytes of an overlong telegram still to be passed over.

   function Announced_Length return Natural is
     (if Received < Header_Length then Header_Length
      else Header_Length + Natural (Incoming (1)) + 256 * Natural (Incoming (2)));

   procedure Answer is
      Reply : Telegram;
      Last  : Natural;
   begin
      Execute (Incoming (Header_Length + 1 .. Received), Reply, Last);
      if Last > 0 and then NXT.Bluetooth.Room >= Header_Length + Last then
         NXT.Bluetooth.Send (To_Bytes (Unsigned_16 (Last)));
         NXT.Bluetooth.Send (Reply (1 .. Last));
      end if;
      Received := 0;
   end Answer;

   procedure Accept_Byte (Item : Byte) is
   begin
      if Skipped_Bytes > 0 then
         Skipped_Bytes := Skipped_Bytes - 1;
         return;
      end if;
      Received := Received + 1;
      Incoming (Received) := Item;
      if Received >= Header_Length and then Announced_Length > Incoming'Last then
         Skipped_Bytes := Announced_Length - Received;
         Received := 0;
      elsif Received > Header_Length and then Received = Announced_Length then
         Answer;
      end if;
   end Accept_Byte;

   procedure Answer_All is
      Data : Byte_Array (1 .. Longest_Telegram);
      Last : Natural;
   begin
      NXT.Bluetooth.Poll;
      NXT.Bluetooth.Receive (Data, Last);
      for Item of Data (1 .. Last) loop
         Accept_Byte (Item);
      end loop;
   end Answer_All;

   procedure Start is
      Address : Eight_Bytes := (others => 0);
   begin
      loop
         NXT.Bluetooth.Initialize;
         exit when NXT.Bluetooth.Available;
         delay until Clock + Retry_Period;
      end loop;
      for Index in NXT.Bluetooth.Address'Range loop
         Address (1 + Index) := NXT.Bluetooth.Address (Index);
      end loop;
      Set_Identity (Program_Name, Address);
      NXT.Bluetooth.Set_Discoverable (True);
      NXT.Bluetooth.Serve (NXT.Bluetooth.To_Pin (Pin));
   end Start;

   procedure Require is null;

   task body Server_Task is
      Period : constant Time_Span := Milliseconds (Period_Ms);
      Next   : Time;
   begin
      Start;
      Next := Clock;
      loop
         if NXT.Bluetooth.State in NXT.Bluetooth.Idle | NXT.Bluetooth.Listening then
            Received := 0;
            Skipped_Bytes := 0;
         end if;
         Answer_All;
         Tick;
         Next := Next + Period;
         delay until Next;
      end loop;
   end Server_Task;

end NXT.Direct_Commands.Bluetooth_Server;
