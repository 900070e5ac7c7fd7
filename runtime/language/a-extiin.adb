--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ravenbrick.Execution_Times;
with Ravenbrick.Registers;

package body Ada.Execution_Time.Interrupts is

   function Clock (Interrupt : Ada.Interrupts.Interrupt_ID) return CPU_Time is
     (CPU_Time
        (Ravenbrick.Execution_Times.Of_Source (Ravenbrick.Registers.Source_Id (Interrupt))));

   function Supported (Interrupt : Ada.Interrupts.Interrupt_ID) return Boolean is
      pragma Unreferenced (Interrupt);
   begin
      return True;
   end Supported;

end Ada.Execution_Time.Interrupts;
