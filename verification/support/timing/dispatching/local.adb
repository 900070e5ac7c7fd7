--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A type that is extended in a subprogram

with Pace;
with Devices.Kinds; use Devices, Devices.Kinds;

procedure Local with Priority => 12 is
   type Own is new Short with null record;
   overriding procedure Start (This : in out Own);
   overriding procedure Start (This : in out Own) is
   begin
      Work (50);
   end Start;
   Mine : Own;
begin
   loop
      delay until Pace.Next;
      Run (This_Device.all);
      Run (Mine);
   end loop;
end Local;
