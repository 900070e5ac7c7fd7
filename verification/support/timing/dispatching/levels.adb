--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  An operation that is inherited over two levels, in a nested package, with a name of its own; and
--  a null procedure that nobody overrides, beside an instance of a generic unit

with Counters;
with Pace;
with Devices.Kinds; use Devices, Devices.Kinds;

procedure Levels with Priority => 12 is
   package Starts is new Counters (Limit => 7);
begin
   loop
      delay until Pace.Next;
      This_Device := (if Pace.Count = 7 then A_Longest'Access else A_Short'Access);
      Starts.Count;
      Start (This_Device.all);
      Rest (This_Device.all);
   end loop;
end Levels;
