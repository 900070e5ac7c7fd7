--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Interfaces;

with Ravenbrick.Failures;
with Ravenbrick.Interrupts;
with Ravenbrick.Processor;

package body System.Tasking.Protected_Objects is

   pragma Suppress (All_Checks);
   --  Lock and Unlock are compiled in line with the application's switches, which ask for checks;
   --  none of these could fail

   use Ravenbrick;
   use Ravenbrick.Threads;
   use type Interfaces.Unsigned_32;

   function Is_Within (Distance, Span : Urgency) return Boolean is
     (Interfaces.Unsigned_32'Mod (Distance) <= Interfaces.Unsigned_32'Mod (Span))
     with Inline_Always;
   --  0 <= Distance <= Span

   procedure Initialize_Protection (Object : Protection_Access; Ceiling_Priority : Integer) is
      Ceiling : constant Urgency := To_Protected_Urgency
        (if Ceiling_Priority = Unspecified_Priority
         then System.Priority'Last
         else Ceiling_Priority);
   begin
      Object.Ceiling := Ceiling;
      Object.Span := (if Ceiling < First_Interrupt_Urgency then Ceiling else 0);
   end Initialize_Protection;

   procedure Lock (Object : Protection_Access) is
      Self   : constant Thread_Id := Kernel.Current;
      Caller : constant Urgency := Self.Active;
   begin
      if Is_Within (Object.Ceiling - Caller, Object.Span) then
         Self.Active := Object.Ceiling;
         Object.Caller := Caller;
      else
         Lock_With_Mask (Object);
      end if;
   end Lock;

   procedure Lock_Read_Only (Object : Protection_Access) is
   begin
      Lock (Object);
   end Lock_Read_Only;

   --  The urgency is raised before the mask: in the reverse order, an interrupt in between could
   --  preempt the caller, whose mask would then delay interrupts for as long as others run. The
   --  object belongs to the caller from the return of Raise_Mask on, not earlier.

   procedure Lock_With_Mask (Object : not null Protection_Access) is
      Self   : constant not null Thread_Id := Kernel.Current;
      Caller : constant Urgency := Self.Active;
      Mask   : Urgency;
   begin
      if Object.Ceiling < Caller then
         Failures.Latest.Object := Object.all'Address;
         Failures.Stop (Failures.Ceiling_Violated'Address);
      end if;
      Self.Active := Object.Ceiling;
      Interrupts.Raise_Mask (Object.Ceiling, Saved => Mask);
      Object.Mask := Mask;
      Object.Caller := -1 - Caller;
   end Lock_With_Mask;

   --  As soon as the mask is lowered, a handler may enter the object: no reading it any more

   procedure Lower_Mask (Object : not null Protection_Access; Caller : out Urgency) is
   begin
      Caller := -1 - Object.Caller;
      Interrupts.Lower_Mask (Object.Ceiling, Saved => Object.Mask);
   end Lower_Mask;

   procedure Leave (Object : not null Protection_Access) is
      Caller : Urgency := Object.Caller;
   begin
      if Caller < 0 then
         Lower_Mask (Object, Caller);
      end if;
      Kernel.Current.Active := Caller;
   end Leave;

   procedure Dispatch is
      Previous : Processor.Status;
   begin
      Processor.Mask_Interrupts (Previous);
      if Processor.In_Thread (Previous) then
         Preempt;
      else
         Processor.Restore_Interrupts (Previous);
      end if;
   end Dispatch;

   --  An interrupt between the two statements after the mask may preempt the caller; it is then
   --  dispatched again only when no more urgent thread is ready

   procedure Unlock (Object : Protection_Access) is
      Caller : Urgency := Object.Caller;
   begin
      if Caller < 0 then
         Lower_Mask (Object, Caller);
      end if;
      Kernel.Current.Active := Caller;
      if Kernel.Ready_Head.Active > Caller then
         Dispatch;
      end if;
   end Unlock;

end System.Tasking.Protected_Objects;
