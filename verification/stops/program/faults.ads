--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Faults of a program whose motor B runs at 50 %, chosen by a test that writes into the image.

package Faults is

   type Fault is
     (Nothing, Exception_In_Task, Exception_In_Handler, Overflow, Loop_In_Task, Loop_Masked,
      Loop_All_Masked, Loop_In_Handler, Task_Returns, Overrun, Data_Abort, Undefined_Instruction,
      Main_Returns, Loop_Before_Delay);

   Chosen : Integer := 0 with Volatile, Export, Convention => C, External_Name => "fault_chosen";
   Phase_Us : Integer := 0 with Volatile, Export, Convention => C, External_Name => "fault_phase";
   --  Of the fault, after the release of a job of the control task

   Began : Integer := 0 with Volatile, Export, Convention => C, External_Name => "fault_began";
   --  Written right before the fault

   function Is_Chosen (Kind : Fault) return Boolean;

   procedure Strike;
   --  Called by each job of the control task: the fault, in the twenty-fifth call

   procedure Hang;

   function Ended return Boolean;
   --  Whether the control task is to return

end Faults;
