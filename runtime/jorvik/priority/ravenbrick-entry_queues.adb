--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body Ravenbrick.Entry_Queues is

   --  A caller that waits has its base priority: it is in no protected action

   procedure Insert (Waiting : in out Queue; Caller : not null Threads.Thread_Id) is
      Previous : Threads.Thread_Id := Waiting.First;
   begin
      if Waiting.Length = 0 or else Outranks (Caller, Previous) then
         Caller.Next := Waiting.First;
         Waiting.First := Caller;
      else
         for Place in 2 .. Waiting.Length loop
            exit when Outranks (Caller, Previous.Next);
            Previous := Previous.Next;
         end loop;
         Caller.Next := Previous.Next;
         Previous.Next := Caller;
      end if;
      Waiting.Length := Waiting.Length + 1;
   end Insert;

   function Outranks (Later, Earlier : not null Threads.Thread_Id) return Boolean is
     (Later.Base_Priority > Earlier.Base_Priority);

end Ravenbrick.Entry_Queues;
