--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  As costs.adb, with Bluetooth and USB, both connected, and direct commands.

with Ada.Real_Time;        use Ada.Real_Time;
with NXT.AVR;
with NXT.Bluetooth;
with NXT.Bytes;            use NXT.Bytes;
with NXT.Direct_Commands;
with NXT.USB;

procedure Line_Costs is

   use NXT;

   Operations : Integer := 11 with
     Volatile, Export, Convention => C, External_Name => "operations";
   Connected : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "connected";
   Received : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "received";

   Packet : NXT.USB.Packet_Data := (others => 16#55#);
   Length : NXT.USB.Packet_Length := 0;
   Last   : Natural := 0;
   Reply  : NXT.Direct_Commands.Telegram;

   Get_Battery : constant Byte_Array := (16#00#, 16#0B#);

   procedure Perform (Operation : Positive) is
   begin
      case Operation is
         when 2      => NXT.Bluetooth.Poll;
         when 3      => NXT.Bluetooth.Send (Packet);
         when 4      => NXT.Bluetooth.Receive (Packet, Last);
         when 5      => Received := Last;
         when 6      => NXT.USB.Send (Packet);
         when 7      => NXT.USB.Receive (Packet, Length);
         when 8      => Received := Received + Length;
         when 9      => NXT.Direct_Commands.Execute (Get_Battery, Reply, Last);
         when 10     => NXT.Direct_Commands.Tick;
         when others => null;
      end case;
   end Perform;

   procedure Await_Connections is
      use type NXT.Bluetooth.Connection_State;
      Next : Time := Clock;
   begin
      loop
         NXT.Bluetooth.Poll;
         exit when NXT.Bluetooth.State = NXT.Bluetooth.Connected and then NXT.USB.Configured;
         Next := Next + Milliseconds (5);
         delay until Next;
      end loop;
      Connected := 1;
   end Await_Connections;

   Next : Time := NXT.AVR.First_Release + Milliseconds (3_001);
begin
   NXT.USB.Attach;
   NXT.Bluetooth.Initialize;
   NXT.Bluetooth.Serve (NXT.Bluetooth.To_Pin ("1234"));
   Await_Connections;
   for Operation in 1 .. Operations loop
      delay until Next;
      Perform (Operation);
      Next := Next + Milliseconds (100);
   end loop;
   pragma Unreferenced (Reply);
   delay until Time_Last;
end Line_Costs;
