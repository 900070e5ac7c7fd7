--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Suspension objects (Ada RM D.10)

private with System.Storage_Elements;

package Ada.Synchronous_Task_Control is
   pragma Preelaborate;

   type Suspension_Object is limited private;

   procedure Set_True (S : in out Suspension_Object);
   --  Release the task suspended on S, or let the next one pass. Interrupt handlers may call it.

   procedure Set_False (S : in out Suspension_Object);

   function Current_State (S : Suspension_Object) return Boolean;

   procedure Suspend_Until_True (S : in out Suspension_Object);
   --  Suspend until S is true, then make it false. Program_Error when a task is suspended on S
   --  already or when the caller is in a protected action.

private

   type Suspension_Object is limited record
      Content : System.Storage_Elements.Integer_Address := 0;
   end record
     with Volatile;
   --  0 when false, 1 when true, otherwise the address of the thread that is suspended

end Ada.Synchronous_Task_Control;
