--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

pragma Assertion_Policy (Check);

with Journal;

procedure Failed_Precondition with Priority => 1 is

   procedure Note_Digit (Value : Natural)
     with Pre => Value < 10;  --  the failing line

   procedure Note_Digit (Value : Natural) is
   begin
      Journal.Note (Character'Val (Character'Pos ('0') + Value));
   end Note_Digit;

begin
   Note_Digit (Journal.Length + 9);
   Note_Digit (Journal.Length + 9);
end Failed_Precondition;
