--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Actions at times, called by the alarm's interrupt. An action waits in the queue of the delayed
--  threads in the shape of a thread that is never created or dispatched. Programs without such
--  actions have neither this code nor its test in the alarm's handler.

with Ravenbrick.Interrupts;
with Ravenbrick.Processor;
with Ravenbrick.Registers;

package Ravenbrick.Delays.Events is
   pragma Preelaborate;

   type Action is access procedure
     (Event : not null Threads.Thread_Id; Previous : Processor.Status)
     with Convention => C;
   --  Called with interrupts masked when Event has left the queue; restores Previous

   procedure Initialize (Expiry : not null Action)
     with Post => Interrupts.Is_Attached (Registers.TC0_Id);
   --  Let the alarm call Expiry, in its handler, for each event whose time has come

   procedure Set (Event : not null Threads.Thread_Id; Wake : Threads.Units)
     with Pre  => Threads.Interrupts_Masked,
          Post => Threads."<=" (Event.Wake, Wake);
   --  Expire at Wake, at once when it has passed; Event is not in the queue

   procedure Cancel (Event : not null Threads.Thread_Id)
     with Pre => Threads.Interrupts_Masked;
   --  Take Event, which is in the queue, out of it

end Ravenbrick.Delays.Events;
