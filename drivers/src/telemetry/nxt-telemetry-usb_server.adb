--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body NXT.Telemetry.USB_Server is

   --  A packet of the host that Receive has not handed over whole
   Held      : USB.Packet_Data;
   Next      : Positive := 1;
   Last_Held : USB.Packet_Length := 0;

   procedure Start is
   begin
      USB.Attach (Serial);
   end Start;

   function Room return Natural is (USB.Packets_Free * USB.Packet_Size);

   procedure Send (Data : Bytes.Byte_Array) is
      First : Positive := Data'First;
      Last  : Natural;
   begin
      while First <= Data'Last loop
         Last := Natural'Min (Data'Last, First + USB.Packet_Size - 1);
         USB.Send (Data (First .. Last));
         First := Last + 1;
      end loop;
   end Send;

   procedure Receive (Data : out Bytes.Byte_Array; Last : out Natural) is
      Count : Natural;
   begin
      Last := Data'First - 1;
      while Last < Data'Last loop
         if Next > Last_Held then
            USB.Receive (Held, Last_Held);
            Next := 1;
            exit when Last_Held = 0;
         end if;
         Count := Natural'Min (Data'Last - Last, Last_Held - Next + 1);
         Data (Last + 1 .. Last + Count) := Held (Next .. Next + Count - 1);
         Last := Last + Count;
         Next := Next + Count;
      end loop;
   end Receive;

   procedure Require is
   begin
      Link_Server.Require;
   end Require;

end NXT.Telemetry.USB_Server;
