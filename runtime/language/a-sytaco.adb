--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ravenbrick.Processor; use Ravenbrick.Processor;

package body Ada.Synchronous_Task_Control is

   use Ravenbrick.Threads;

   procedure Set_True (S : in out Suspension_Object) is
      Previous : Status;
      Released : Thread_Id;
   begin
      Mask_Interrupts (Previous);
      Released := S.Waiting;
      if Released = null then
         S.State := True;
      else
         S.Waiting := null;
         Make_Ready (Released);
         if In_Thread (Previous) then
            Preempt;
         end if;
      end if;
      Restore_Interrupts (Previous);
   end Set_True;

   procedure Set_False (S : in out Suspension_Object) is
   begin
      S.State := False;
   end Set_False;

   function Current_State (S : Suspension_Object) return Boolean is (S.State);

   procedure Suspend_Until_True (S : in out Suspension_Object) is
      Self     : constant not null Thread_Id := Kernel.Current;
      Previous : Status;
   begin
      Mask_Interrupts (Previous);
      if S.Waiting /= null or else In_Protected_Action (Self.Active) then
         raise Program_Error with "suspension in a protected action or of a second task";
      end if;
      if S.State then
         S.State := False;
      else
         S.Waiting := Self;
         Self.State := Suspended;
         Block;
      end if;
      Restore_Interrupts (Previous);
   end Suspend_Until_True;

end Ada.Synchronous_Task_Control;
