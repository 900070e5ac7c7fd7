--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Termination of tasks (Ada RM C.7.3) as the profile has it: one fall-back handler for all tasks.
--  A task terminates only at the end of its body; one that fails stops the program.

with Ada.Exceptions;
with Ada.Task_Identification;

package Ada.Task_Termination is

   type Cause_Of_Termination is (Normal, Abnormal, Unhandled_Exception);

   type Termination_Handler is access protected procedure
     (Cause : Cause_Of_Termination;
      T     : Ada.Task_Identification.Task_Id;
      X     : Ada.Exceptions.Exception_Occurrence);

   procedure Set_Dependents_Fallback_Handler (Handler : Termination_Handler);
   --  From now on each task that ends calls Handler with Normal, itself and Null_Occurrence;
   --  null: none

   function Current_Task_Fallback_Handler return Termination_Handler;

   --  Forbidden (No_Specific_Termination_Handlers); declared so that the compiler can say so

   procedure Set_Specific_Handler
     (T : Ada.Task_Identification.Task_Id; Handler : Termination_Handler) with Import;

   function Specific_Handler
     (T : Ada.Task_Identification.Task_Id) return Termination_Handler with Import;

end Ada.Task_Termination;
