--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The order in which waiting tasks are served (Ada RM D.4). It has two bodies: fifo/ has the order
--  of the calls; priority/ that of the callers' priorities, in the library of QUEUING=priority.
--  There system.ads names the policy, so that a program which asks for another does not compile.

with Ravenbrick.Threads;

package Ravenbrick.Entry_Queues is
   pragma Preelaborate;

   use type Threads.Thread_Id;

   type Queue is record
      First  : Threads.Thread_Id;
      Last   : Threads.Thread_Id;
      Length : Natural;
   end record
     with Suppress_Initialization;
   --  Threads that wait on one entry, linked by their Next, in the order of service; First and Last
   --  are meaningless when Length is 0

   procedure Insert (Waiting : in out Queue; Caller : not null Threads.Thread_Id)
     with Inline,
          Post => Waiting.Length = Waiting.Length'Old + 1;
   --  Caller waits in none of the kernel's queues

   function Outranks (Later, Earlier : not null Threads.Thread_Id) return Boolean
     with Inline_Always,
          Pre => Later /= Earlier;
   --  Whether Later is served before Earlier though its entry is declared, or its call was made,
   --  after that of Earlier

end Ravenbrick.Entry_Queues;
