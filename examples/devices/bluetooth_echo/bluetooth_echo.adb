--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Bluetooth: whoever knows the code 1234 may connect, and gets back what it sends.

with Ada.Real_Time;  use Ada.Real_Time;
with NXT.AVR;
with NXT.Bluetooth;  use NXT.Bluetooth;
with NXT.Bytes;      use NXT.Bytes;
with NXT.Display;    use NXT.Display;
pragma Unreferenced (NXT.AVR);
--  The power button switches the brick off.

procedure Bluetooth_Echo is

   subtype Word is String (1 .. 10);
   Words : constant array (Connection_State) of Word :=
     (Idle => "idle      ", Listening => "listening ", Calling => "calling   ",
      Opening => "opening   ", Connected => "connected ", Closing => "closing   ");

   Name   : Friendly_Name;
   Data   : Byte_Array (1 .. 64);
   Last   : Natural;
   Echoed : Natural := 0;
   Shown  : Connection_State := Idle;
   Next   : Time;

   procedure Show_State is
   begin
      if State /= Shown then
         Shown := State;
         Put_At (0, 2, Words (Shown));
      end if;
   end Show_State;

   procedure Show_Address is
   begin
      Put_At_Noupdate (0, 0, "address");
      Set_Pos (0, 1);
      for Part of Address (0 .. 5) loop
         Put_Hex (Part);
      end loop;
   end Show_Address;

begin
   Initialize;
   Convert_To_Friendly_Name ("echo", Name);
   Set_Friendly_Name (Name);
   Set_Discoverable (True);
   Show_Address;
   Serve (To_Pin ("1234"));
   Next := Clock;
   loop
      Poll;
      Show_State;
      Receive (Data, Last);
      if Last > 0 and then Room >= Last then
         Send (Data (1 .. Last));
         Echoed := Echoed + Last;
         Put_At_Noupdate (0, 3, "bytes");
         Set_Pos (6, 3);
         Put (Echoed, Width => 6);
      end if;
      Next := Next + Milliseconds (5);
      delay until Next;
   end loop;
end Bluetooth_Echo;
