--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Journal; use Journal;

--  A handler in the same subprogram takes an exception

procedure Local_Handler is
   Limit : Integer := 3 with Volatile;
   subtype Small is Integer range 0 .. 3;
   Value : Small := 0 with Volatile;
begin
   begin
      Note ('a');
      if Limit = 3 then
         raise Constraint_Error;
      end if;
      Note ('b');
   exception
      when Constraint_Error =>
         Note ('c');
   end;
   Note ('d');
   Value := Limit + 1;
   Note ('e');
end Local_Handler;
