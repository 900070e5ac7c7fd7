--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

pragma Assertion_Policy (Check);

with Journal;

procedure Failed_Contract with Priority => 1 is

   function Rounded (Value : Natural) return Natural
     with Pre  => Value < 100,
          Post => Rounded'Result mod 10 = 0;  --  the failing line

   function Rounded (Value : Natural) return Natural is
     (if Value = 7 then Value else Value / 10 * 10);

begin
   if Rounded (12 + Journal.Length) = 10 then
      Journal.Note ('a');
   end if;
   if Rounded (6 + Journal.Length) = 10 then
      Journal.Note ('b');
   end if;
end Failed_Contract;
