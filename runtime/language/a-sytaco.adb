--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Unchecked_Conversion;

with Ravenbrick.Failures;
with Ravenbrick.Processor; use Ravenbrick.Processor;
with Ravenbrick.Threads;

package body Ada.Synchronous_Task_Control is

   use Ravenbrick;
   use Ravenbrick.Threads;
   use System.Storage_Elements;

   False_Content : constant Integer_Address := 0;
   True_Content  : constant Integer_Address := 1;

   function To_Content is new Ada.Unchecked_Conversion (Thread_Id, Integer_Address);
   pragma Warnings (Off, "possible aliasing problem*");
   pragma Warnings (Off, "use -fno-strict-aliasing*");
   pragma Warnings (Off, "or use *No_Strict_Aliasing*");
   function To_Thread is new Ada.Unchecked_Conversion (Integer_Address, Thread_Id);
   pragma Warnings (On);

   procedure Release_By_Thread (Woken : not null Thread_Id) with No_Inline;
   --  Apart, because the exchange of contexts needs all registers saved

   procedure Release_By_Thread (Woken : not null Thread_Id) is
   begin
      Release (Kernel.Current, Woken);
   end Release_By_Thread;

   procedure Set_True (S : in out Suspension_Object) is
      Previous : Status;
      Content  : Integer_Address;
   begin
      Mask_Interrupts (Previous);
      Content := S.Content;
      if Content <= True_Content then
         S.Content := True_Content;
         Restore_Interrupts (Previous);
      else
         S.Content := False_Content;
         if In_Thread (Previous) then
            Release_By_Thread (To_Thread (Content));
         else
            Make_Ready (To_Thread (Content));
            Restore_Interrupts (Previous);
         end if;
      end if;
   end Set_True;

   procedure Set_False (S : in out Suspension_Object) is
      Previous : Status;
   begin
      Mask_Interrupts (Previous);
      if S.Content = True_Content then
         S.Content := False_Content;
      end if;
      Restore_Interrupts (Previous);
   end Set_False;

   function Current_State (S : Suspension_Object) return Boolean is (S.Content = True_Content);

   procedure Suspend_Until_True (S : in out Suspension_Object) is
      Self : constant not null Thread_Id := Kernel.Current;
   begin
      if In_Protected_Action (Self.Active) then
         Failures.Stop (Failures.Blocking'Address);
      end if;
      Mask_In_Thread;
      if S.Content = False_Content then
         S.Content := To_Content (Self);
         Self.State := Suspended;
         Block (Self);
      elsif S.Content = True_Content then
         S.Content := False_Content;
         Unmask_In_Thread;
      else
         Failures.Stop (Failures.Second_Suspended'Address);
      end if;
   end Suspend_Until_True;

end Ada.Synchronous_Task_Control;
