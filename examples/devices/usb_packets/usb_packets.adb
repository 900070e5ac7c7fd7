--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  USB: counts the packets that a host sends, and sends each back.

with Ada.Real_Time;  use Ada.Real_Time;
with NXT.AVR;
with NXT.Display;    use NXT.Display;
with NXT.USB;        use NXT.USB;
pragma Unreferenced (NXT.AVR);
--  The power button switches the brick off.

procedure USB_Packets is

   Data    : Packet_Data;
   Length  : Packet_Length;
   Packets : Natural := 0;
   Next    : Time := Clock;
begin
   Attach;
   Put_At (0, 0, "no host");
   loop
      Next := Next + Milliseconds (5);
      delay until Next;
      if Configured and then Packets_Free > 0 then
         Receive (Data, Length);
         if Length > 0 then
            Send (Data (1 .. Length));
            Packets := Packets + 1;
            Put_At_Noupdate (0, 0, "packets");
            Set_Pos (8, 0);
            Put (Packets, Width => 4);
         end if;
      end if;
   end loop;
end USB_Packets;
