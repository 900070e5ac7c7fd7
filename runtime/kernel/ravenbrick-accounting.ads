--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The hook for execution-time clocks where the kernel gives the processor to another thread. It
--  has two bodies: plain/ does nothing and costs nothing; timed/ charges the time since the last
--  charge to the current thread or handler and is linked with EXECUTION_TIME=yes only.

with Ravenbrick.Threads;

package Ravenbrick.Accounting is
   pragma Preelaborate;

   procedure Charge
     with Inline_Always,
          Global => (In_Out => Threads.Kernel);
   --  Interrupts are masked

end Ravenbrick.Accounting;
