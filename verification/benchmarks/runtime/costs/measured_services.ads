--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Costs of the kernel's primitives, timed by the program itself with a timer that counts every
--  second cycle. Between two samples passes a random number of cycles.

with System;

with Series; use Series;

package Measured_Services is

   type Figure is
     (Two_Readings,          --  of the timer, one after the other: to be subtracted
      Plain_Call,            --  of a subprogram with the body of the protected procedure
      Protected_Call,        --  lock, body, unlock
      Open_Entry_Call,       --  of an entry whose barrier is true
      Voluntary_Switch,      --  Suspend_Until_True until the next task goes on
      Task_Released,         --  Set_True until the higher task that it releases goes on
      Entry_Opened,          --  protected procedure until the higher task on the entry goes on
      Interrupt_To_Handler,  --  request until the handler's first statement
      Interrupt_To_Task);    --  request until the task that the handler releases

   type Summaries is array (Figure) of Summary with Convention => C;

   Results : Summaries
     with Export, Convention => C, External_Name => "results";

   Finished : Boolean := False
     with Volatile, Export, Convention => C, External_Name => "finished";

   Samples : constant := 10_000;

   task Low with Priority => 10, Storage_Size => 1024;
   task High with Priority => 12, Storage_Size => 768;
   task Waiting with Priority => 13, Storage_Size => 768;
   task Server with Priority => 20, Storage_Size => 768;

   Level : constant System.Interrupt_Priority := System.Interrupt_Priority'First + 4;

end Measured_Services;
