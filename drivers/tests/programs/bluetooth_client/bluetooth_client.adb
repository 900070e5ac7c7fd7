--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A brick that looks for others, connects to the first one with a wrong and then with the right
--  code, and sends it numbers; then it connects again, known by now.

with Ada.Real_Time;  use Ada.Real_Time;
with Interfaces;     use Interfaces;
with NXT.Bluetooth;  use NXT.Bluetooth;

procedure Bluetooth_Client is

   package Numbers is new NXT.Bluetooth.IO (Unsigned_32);

   type Results is array (1 .. 4) of Integer;

   Seen     : Integer := -1 with
     Volatile, Export, Convention => C, External_Name => "devices_found";
   Listed   : Integer := -1 with
     Volatile, Export, Convention => C, External_Name => "peers_listed";
   Wrong    : Integer := -1 with
     Volatile, Export, Convention => C, External_Name => "wrong_code";
   Answers  : Results := (others => 0) with
     Volatile, Export, Convention => C, External_Name => "answers";
   Found    : Device_List (0 .. 3) with Export, Convention => C, External_Name => "found";
   Known    : Device_List (0 .. 3) with Export, Convention => C, External_Name => "known";
   Count    : Natural;
   Success  : Boolean;
   Item     : aliased Unsigned_32 := 0;

   procedure Exchange (First : Positive) is
   begin
      for Index in First .. First + 1 loop
         Item := Unsigned_32 (100 * Index);
         Numbers.Send (Item'Access);
         Numbers.Receive (Item'Access);
         Answers (Index) := Integer (Item);
      end loop;
   end Exchange;

   procedure Part is
   begin
      Disconnect;
      while State /= Idle loop
         Poll;
         delay until Clock + Milliseconds (2);
      end loop;
      delay until Clock + Milliseconds (300);
   end Part;

begin
   Initialize;
   delay until Clock + Seconds (1);
   Find_Discoverable_Devices (5, Found, Count);
   Seen := Count;
   if Count > 0 then
      Connect (Found (0).Addr, To_Pin ("9999"), Success);
      Wrong := Boolean'Pos (Success);
      Connect (Found (0).Addr, To_Pin ("0815"), Success);
      if Success then
         Exchange (1);
         Part;
         Connect (Found (0).Addr, Success);
      end if;
      if Success then
         Exchange (3);
         Part;
      end if;
      Add_Known_Device (Found (0), Success);
      Get_Known_Peers (Known, Count);
      Listed := (if Success then Count else 0);
   end if;
   delay until Time_Last;
end Bluetooth_Client;
