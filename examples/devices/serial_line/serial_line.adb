--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The RS485 line of port 4, looped back within the processor: what is sent comes back.

with Ada.Real_Time;  use Ada.Real_Time;
with NXT.AVR;
with NXT.Display;    use NXT.Display;
with NXT.RS485;      use NXT.RS485;
pragma Unreferenced (NXT.AVR);
--  The power button switches the brick off.

procedure Serial_Line is

   Text     : constant String := "over the wire";
   Message  : Byte_Array (Text'Range);
   Answer   : Byte_Array (1 .. 16);
   Count    : Natural;
   Accepted : Boolean;
begin
   Open (Rate => 115_200, To => Loop_Back);
   for Place in Text'Range loop
      Message (Place) := Character'Pos (Text (Place));
   end loop;
   Send (Message, Accepted);
   if Accepted then
      Await_Sent;
      Receive (Answer, Count);
      for Place in 1 .. Count loop
         Put_Noupdate (Character'Val (Answer (Place)));
      end loop;
      Screen_Update;
   end if;
   delay until Time_Last;
end Serial_Line;
