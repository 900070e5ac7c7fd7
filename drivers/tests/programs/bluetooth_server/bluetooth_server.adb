--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A brick that others find and connect to; it doubles every number that it gets.

with Interfaces;     use Interfaces;
with NXT.Bluetooth;  use NXT.Bluetooth;

procedure Bluetooth_Server is

   package Numbers is new NXT.Bluetooth.IO (Unsigned_32);

   Name        : Friendly_Name;
   Peer        : BT_Address;
   Success     : Boolean;
   Connections : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "connections";
   Item        : aliased Unsigned_32 := 0;
begin
   Initialize;
   Convert_To_Friendly_Name ("doubling brick with a long name", Name);
   Set_Friendly_Name (Name);
   Set_Discoverable (True);
   loop
      Accept_Connection (To_Pin ("0815"), Peer, Success);
      if Success then
         Connections := Connections + 1;
      end if;
      while State = Connected loop
         Numbers.Receive (Item'Access);
         Item := 2 * Item;
         if State = Connected then
            Numbers.Send (Item'Access);
         end if;
      end loop;
   end loop;
end Bluetooth_Server;
