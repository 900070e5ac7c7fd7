--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A call through an access-to-subprogram value, on the line of a dispatching one

with Pace;
with Callbacks;
with Devices.Kinds; use Devices, Devices.Kinds;

procedure Called_Back with Priority => 12 is
   The_Table  : aliased Callbacks.Table := (Call => Work'Access);
   The_Holder : Callbacks.Holder := (Now => The_Table'Unchecked_Access) with Volatile;
begin
   loop
      delay until Pace.Next;
      Start (This_Device.all); The_Holder.Now.Call (5);
   end loop;
end Called_Back;
