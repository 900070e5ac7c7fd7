--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with System.Tasking;

package body Ada.Task_Termination is

   Fallback : Termination_Handler := null;

   procedure Call_Fallback;
   --  By the task that ends

   procedure Call_Fallback is
   begin
      if Fallback /= null then
         Fallback
           (Normal, Ada.Task_Identification.Current_Task, Ada.Exceptions.Null_Occurrence);
      end if;
   end Call_Fallback;

   procedure Set_Dependents_Fallback_Handler (Handler : Termination_Handler) is
   begin
      Fallback := Handler;
      System.Tasking.At_Termination := Call_Fallback'Access;
   end Set_Dependents_Fallback_Handler;

   function Current_Task_Fallback_Handler return Termination_Handler is (Fallback);

end Ada.Task_Termination;
