--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;  use Ada.Real_Time;
with Interfaces;     use Interfaces;
with NXT.Bluetooth;

package body NXT.Direct_Commands.Bluetooth_Server is

   Header_Length : constant := 2;
   Retry_Period  : constant Time_Span := Seconds (1);

   task Talker with Priority => Priority, Storage_Size => Stack_Bytes;

   --  What has come of a telegram, its length included.

   Coming : Byte_Array (1 .. Header_Length + Longest_Telegram);
   Came   : Natural := 0;
   Passed : Natural := 0;
   --  Passed: bytes of an overlong telegram still to be passed over.

   function Wanted return Natural is
     (if Came < Header_Length then Header_Length
      else Header_Length + Natural (Coming (1)) + 256 * Natural (Coming (2)));

   procedure Answer is
      Reply : Telegram;
      Last  : Natural;
   begin
      Obey (Coming (Header_Length + 1 .. Came), Reply, Last);
      if Last > 0 and then NXT.Bluetooth.Room >= Header_Length + Last then
         NXT.Bluetooth.Send (To_Bytes (Unsigned_16 (Last)));
         NXT.Bluetooth.Send (Reply (1 .. Last));
      end if;
      Came := 0;
   end Answer;

   procedure Take (Item : Byte) is
   begin
      if Passed > 0 then
         Passed := Passed - 1;
         return;
      end if;
      Came := Came + 1;
      Coming (Came) := Item;
      if Came >= Header_Length and then Wanted > Coming'Last then
         Passed := Wanted - Came;
         Came := 0;
      elsif Came > Header_Length and then Came = Wanted then
         Answer;
      end if;
   end Take;

   procedure Answer_All is
      Data : Byte_Array (1 .. Longest_Telegram);
      Last : Natural;
   begin
      NXT.Bluetooth.Poll;
      NXT.Bluetooth.Receive (Data, Last);
      for Item of Data (1 .. Last) loop
         Take (Item);
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
      Introduce (Program_Name, Address);
      NXT.Bluetooth.Set_Discoverable (True);
      NXT.Bluetooth.Serve (NXT.Bluetooth.To_Pin (Pin));
   end Start;

   procedure Require is null;

   task body Talker is
      Period : constant Time_Span := Milliseconds (Period_Ms);
      Next   : Time;
   begin
      Start;
      Next := Clock;
      loop
         if NXT.Bluetooth.State in NXT.Bluetooth.Idle | NXT.Bluetooth.Listening then
            Came := 0;
            Passed := 0;
         end if;
         Answer_All;
         Tick;
         Next := Next + Period;
         delay until Next;
      end loop;
   end Talker;

end NXT.Direct_Commands.Bluetooth_Server;
