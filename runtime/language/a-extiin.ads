--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Execution time of interrupt handlers (Ada RM D.14.3): from the interrupt entry to its exit,
--  without handlers of higher levels that come in between

with Ada.Interrupts;

package Ada.Execution_Time.Interrupts is

   function Clock (Interrupt : Ada.Interrupts.Interrupt_ID) return CPU_Time
     with Volatile_Function;

   function Supported (Interrupt : Ada.Interrupts.Interrupt_ID) return Boolean;
   --  True for every source

end Ada.Execution_Time.Interrupts;
