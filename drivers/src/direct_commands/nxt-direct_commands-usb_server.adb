--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;  use Ada.Real_Time;
with NXT.USB;

package body NXT.Direct_Commands.USB_Server is

   task Server_Task with Priority => Priority, Storage_Size => Stack_Bytes;

   procedure Answer_All is
      Item   : NXT.USB.Packet_Data;
      Length : NXT.USB.Packet_Length;
      Reply  : Telegram;
      Last   : Natural;
   begin
      while NXT.USB.Packets_Free > 0 loop
         NXT.USB.Receive (Item, Length);
         exit when Length = 0;
         Execute (Item (1 .. Length), Reply, Last);
         if Last > 0 then
            NXT.USB.Send (Reply (1 .. Last));
         end if;
      end loop;
   end Answer_All;

   procedure Require is null;

   task body Server_Task is
      Period : constant Time_Span := Milliseconds (Period_Ms);
      Next   : Time := Clock;
   begin
      Set_Identity (Program_Name, (others => 0));
      NXT.USB.Attach;
      loop
         Answer_All;
         Tick;
         Next := Next + Period;
         delay until Next;
      end loop;
   end Server_Task;

end NXT.Direct_Commands.USB_Server;
