--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A type that is extended in a subprogram

with Ada.Real_Time; use Ada.Real_Time;
with Devices.Kinds; use Devices, Devices.Kinds;

procedure Local with Priority => 12 is
   Next  : Time := Clock + Milliseconds (20);
   Count : Natural := 0 with Volatile;
   type Own is new Short with null record;
   overriding procedure Start (This : in out Own);
   overriding procedure Start (This : in out Own) is
   begin
      Work (50);
   end Start;
   Mine : Own;
begin
   loop
      delay until Next;
      Count := (Count + 1) mod 50;
      Run (This_Device.all);
      Run (Mine);
      Next := Next + Milliseconds (4);
   end loop;
end Local;
