--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ravenbrick.Interrupts;
with Ravenbrick.Processor;

package body System.Tasking.Protected_Objects is

   use Ravenbrick.Threads;

   procedure Initialize_Protection (Object : Protection_Access; Ceiling_Priority : Integer) is
   begin
      Object.Ceiling := To_Protected_Urgency
        (if Ceiling_Priority = Unspecified_Priority
         then System.Priority'Last
         else Ceiling_Priority);
   end Initialize_Protection;

   procedure Lock (Object : Protection_Access) is
      Self    : constant not null Thread_Id := Kernel.Current;
      Caller  : constant Urgency := Self.Active;
      Ceiling : constant Urgency := Object.Ceiling;
   begin
      if Ceiling < Caller then
         raise Program_Error with "ceiling violation";
      end if;
      Object.Caller := Caller;
      Self.Active := Ceiling;
      if Ceiling > First_Interrupt_Urgency and then Ceiling > Caller then
         Ravenbrick.Interrupts.Raise_Mask (Ceiling, Saved => Object.Mask);
      end if;
   end Lock;

   procedure Dispatch;
   --  The part of Unlock that is rarely needed

   procedure Dispatch is
      Previous : Ravenbrick.Processor.Status;
   begin
      Ravenbrick.Processor.Mask_Interrupts (Previous);
      if Ravenbrick.Processor.In_Thread (Previous) then
         Preempt;
      end if;
      Ravenbrick.Processor.Restore_Interrupts (Previous);
   end Dispatch;

   procedure Leave (Object : not null Protection_Access) is
      Caller  : constant Urgency := Object.Caller;
      Ceiling : constant Urgency := Object.Ceiling;
   begin
      if Ceiling > First_Interrupt_Urgency and then Ceiling > Caller then
         Ravenbrick.Interrupts.Lower_Mask (Ceiling, Saved => Object.Mask);
      end if;
      Kernel.Current.Active := Caller;
   end Leave;

   procedure Unlock (Object : Protection_Access) is
      Caller : constant Urgency := Object.Caller;
   begin
      Leave (Object);
      if Kernel.Ready_Head.Active > Caller then
         Dispatch;
      end if;
   end Unlock;

end System.Tasking.Protected_Objects;
