--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body Ravenbrick.Entry_Queues is

   procedure Insert (Waiting : in out Queue; Caller : not null Threads.Thread_Id) is
   begin
      if Waiting.Length = 0 then
         Waiting.First := Caller;
      else
         Waiting.Last.Next := Caller;
      end if;
      Waiting.Last := Caller;
      Waiting.Length := Waiting.Length + 1;
   end Insert;

   function Outranks (Later, Earlier : not null Threads.Thread_Id) return Boolean is
      pragma Unreferenced (Later, Earlier);
   begin
      return False;
   end Outranks;

end Ravenbrick.Entry_Queues;
