--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

pragma Assertion_Policy (Check);

with Journal;

procedure Failed_Assertion with Priority => 1 is
begin
   Journal.Note ('a');
   pragma Assert (Journal.Length = 1);
   pragma Assert (Journal.Length = 2);  --  the failing line
   Journal.Note ('b');
end Failed_Assertion;
