--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

pragma Assertion_Policy (Check);

with Journal;

procedure Assertion_Message with Priority => 1 is
begin
   pragma Assert (Journal.Length = 1, "journal has 1");
end Assertion_Message;
