--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  An operation of an interface

with Pace;
with Devices.Kinds; use Devices, Devices.Kinds;

procedure Signals with Priority => 12 is
begin
   loop
      delay until Pace.Next;
      Send (This_Signal.all);
   end loop;
end Signals;
