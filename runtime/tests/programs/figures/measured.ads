--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Costs of the kernel's primitives in cycles, measured with a timer of 2 cycles' resolution

with Interfaces;

package Measured is

   subtype Figure is Interfaces.Unsigned_32;

   type Figures_Record is record
      Stopwatch       : Figure;  --  two readings after each other
      Protected_Call  : Figure;  --  100 calls of an empty protected procedure, free of loop
      Round_Trip      : Figure;  --  Set_True that releases a higher task until it suspends again
      Suspend_To_Next : Figure;  --  Suspend_Until_True until the next task goes on
      Entry_Opened    : Figure;  --  protected procedure call until the waiting task goes on
      To_Handler      : Figure;  --  compare event until the handler's first statement
      To_Task         : Figure;  --  compare event until the task that the handler releases
      To_Handler_Max  : Figure;
      To_Task_Max     : Figure;
      Interrupts      : Figure;  --  observations of the latter four
   end record
     with Volatile, Convention => C;

   Results : Figures_Record := (others => 0)
     with Export, Convention => C, External_Name => "results";

   task Low with Priority => 10, Storage_Size => 768;
   task High with Priority => 12, Storage_Size => 768;
   task Waiting with Priority => 13, Storage_Size => 768;
   task Server with Priority => 20, Storage_Size => 768;

end Measured;
