--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Execution times of threads and handlers, to the tick of the clock. A program that calls these
--  does not link without EXECUTION_TIME=yes. A handler's time is its own, not that of the thread
--  that it interrupts; a service of the kernel belongs to its caller; idle time to nobody.

with Ravenbrick.Registers;
with Ravenbrick.Threads;

package Ravenbrick.Execution_Times is
   pragma Preelaborate;

   subtype Units is Threads.Units;
   use type Threads.Units;

   function Of_Thread (Id : not null Threads.Thread_Id) return Units
     with Post => Of_Thread'Result >= 0;

   function Of_Source (Source : Registers.Source_Id) return Units
     with Post => Of_Source'Result >= 0;
   --  Of the handlers of an interrupt source

   function Of_Interrupts return Units
     with Post => Of_Interrupts'Result >= 0;
   --  Of all handlers

end Ravenbrick.Execution_Times;
