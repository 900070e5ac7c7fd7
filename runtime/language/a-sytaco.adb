--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ravenbrick.Failures;
with Ravenbrick.Processor; use Ravenbrick.Processor;

package body Ada.Synchronous_Task_Control is

   use Ravenbrick;
   use Ravenbrick.Threads;

   procedure Set_True (S : in out Suspension_Object) is
      Previous : Status;
      Released : Thread_Id;
   begin
      Mask_Interrupts (Previous);
      Released := S.Waiting;
      if Released = null then
         S.State := True;
         Restore_Interrupts (Previous);
      else
         S.Waiting := null;
         if In_Thread (Previous) then
            Release (Released);
         else
            Make_Ready (Released);
            Restore_Interrupts (Previous);
         end if;
      end if;
   end Set_True;

   procedure Set_False (S : in out Suspension_Object) is
   begin
      S.State := False;
   end Set_False;

   function Current_State (S : Suspension_Object) return Boolean is (S.State);

   procedure Suspend_Until_True (S : in out Suspension_Object) is
      Self : constant not null Thread_Id := Kernel.Current;
   begin
      if In_Protected_Action (Self.Active) then
         Failures.Stop (Failures.Blocking'Address);
      end if;
      Mask_In_Thread;
      if S.Waiting /= null then
         Failures.Stop (Failures.Second_Suspended'Address);
      end if;
      if S.State then
         S.State := False;
         Unmask_In_Thread;
      else
         S.Waiting := Self;
         Self.State := Suspended;
         Block;
      end if;
   end Suspend_Until_True;

end Ada.Synchronous_Task_Control;
