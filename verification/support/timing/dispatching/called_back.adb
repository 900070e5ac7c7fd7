--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A call through an access-to-subprogram value, on the line of a dispatching one

with Ada.Real_Time; use Ada.Real_Time;
with Callbacks;
with Devices.Kinds; use Devices, Devices.Kinds;

procedure Called_Back with Priority => 12 is
   Next  : Time := Clock + Milliseconds (20);
   Count : Natural := 0 with Volatile;
   The_Table  : aliased Callbacks.Table := (Call => Work'Access);
   The_Holder : Callbacks.Holder := (Now => The_Table'Unchecked_Access) with Volatile;
begin
   loop
      delay until Next;
      Count := (Count + 1) mod 50;
      Start (This_Device.all); The_Holder.Now.Call (5);
      Next := Next + Milliseconds (4);
   end loop;
end Called_Back;
