--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Task identification (Ada RM C.7.1), without abort

with System.Tasking;

package Ada.Task_Identification is
   pragma Preelaborate;

   type Task_Id is private;
   pragma Preelaborable_Initialization (Task_Id);

   Null_Task_Id : constant Task_Id;

   function "=" (Left, Right : Task_Id) return Boolean;

   function Image (T : Task_Id) return String;
   --  The name that pragma Task_Name gives in the task's definition, "environment" for the
   --  environment task; otherwise eight hexadecimal digits, the address of the control block, which
   --  the linker's map names. Under the Ravenscar profile the compiler passes no other names.
   --  Empty for Null_Task_Id.

   function Current_Task return Task_Id with Volatile_Function;
   function Environment_Task return Task_Id;

   function Is_Terminated (T : Task_Id) return Boolean with Volatile_Function;
   function Is_Callable (T : Task_Id) return Boolean with Volatile_Function;
   function Activation_Is_Complete (T : Task_Id) return Boolean with Volatile_Function;
   --  Program_Error for Null_Task_Id

private

   type Task_Id is new System.Tasking.Task_Id;

   pragma Import (Intrinsic, "=");

   Null_Task_Id : constant Task_Id := null;

end Ada.Task_Identification;
