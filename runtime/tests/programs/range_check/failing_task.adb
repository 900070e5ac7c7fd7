--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;

with Journal; use Journal;

package body Failing_Task is

   subtype Small is Integer range 0 .. 9;

   Value : Integer := 0 with Volatile;
   Digit : Small   := 0 with Volatile;

   procedure Hook (Message : System.Address; Line : Integer) is
   begin
      Hook_Message := Message;
      Hook_Line := Line;
      Note ('!');
   end Hook;

   task body Counter is
      Next : Time := Clock;
   begin
      loop
         Next := Next + Milliseconds (1);
         delay until Next;
         Digit := Value;  --  the failing line
         Note (Character'Val (Character'Pos ('0') + Digit));
         Value := Value + 1;
      end loop;
   end Counter;

end Failing_Task;
