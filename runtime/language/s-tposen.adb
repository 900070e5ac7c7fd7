--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ravenbrick.Failures;
with Ravenbrick.Processor;

package body System.Tasking.Protected_Objects.Single_Entry is

   use Ravenbrick.Threads;

   The_Entry : constant Protected_Entry_Index := 1;

   procedure Execute
     (Object     : not null Protection_Entry_Access;
      Caller     : not null Thread_Id;
      Parameters : System.Address)
     with Inline;

   procedure Wait (Object : not null Protection_Entry_Access);
   --  Leave the object and block until the entry has been executed

   procedure Initialize_Protection_Entry
     (Object           : Protection_Entry_Access;
      Ceiling_Priority : Integer;
      Compiler_Info    : System.Address;
      Entry_Body       : Entry_Body_Access) is
   begin
      Initialize_Protection (Object.Common'Access, Ceiling_Priority);
      Object.Info := Compiler_Info;
      Object.Code := Entry_Body;
      Object.Waiting := null;
      Object.In_Service := null;
   end Initialize_Protection_Entry;

   procedure Lock_Entry (Object : Protection_Entry_Access) is
   begin
      Lock (Object.Common'Access);
   end Lock_Entry;

   procedure Lock_Read_Only_Entry (Object : Protection_Entry_Access) is
   begin
      Lock (Object.Common'Access);
   end Lock_Read_Only_Entry;

   procedure Unlock_Entry (Object : Protection_Entry_Access) is
   begin
      Unlock (Object.Common'Access);
   end Unlock_Entry;

   procedure Execute
     (Object     : not null Protection_Entry_Access;
      Caller     : not null Thread_Id;
      Parameters : System.Address) is
   begin
      Object.In_Service := Caller;
      Object.Code.Action (Object.Info, Parameters, The_Entry);
      Object.In_Service := null;
   end Execute;

   procedure Service_Entry (Object : Protection_Entry_Access) is
      Caller   : constant Thread_Id := Object.Waiting;
      Previous : Ravenbrick.Processor.Status;
   begin
      if Caller /= null and then Object.Code.Barrier (Object.Info, The_Entry) then
         Object.Waiting := null;
         Execute (Object, Caller, Caller.Entry_Parameters);
         Ravenbrick.Processor.Mask_Interrupts (Previous);
         Make_Ready (Caller);
         Ravenbrick.Processor.Restore_Interrupts (Previous);
      end if;
      Unlock (Object.Common'Access);
   end Service_Entry;

   procedure Wait (Object : not null Protection_Entry_Access) is
      Self : constant not null Thread_Id := Kernel.Current;
   begin
      Object.Waiting := Self;
      Ravenbrick.Processor.Mask_In_Thread;
      Leave (Object.Common'Access);
      Self.State := Blocked_On_Entry;
      Block (Self);
   end Wait;

   procedure Protected_Single_Entry_Call
     (Object : Protection_Entry_Access; Uninterpreted_Data : System.Address)
   is
      Self : constant not null Thread_Id := Kernel.Current;
   begin
      if In_Protected_Action (Self.Active) then
         Ravenbrick.Failures.Stop (Ravenbrick.Failures.Blocking'Address);
      end if;
      Lock (Object.Common'Access);
      if Object.Code.Barrier (Object.Info, The_Entry) then
         Execute (Object, Self, Uninterpreted_Data);
         Unlock (Object.Common'Access);
      elsif Object.Waiting = null then
         Self.Entry_Parameters := Uninterpreted_Data;
         Wait (Object);
      else
         Ravenbrick.Failures.Stop (Ravenbrick.Failures.Entry_Queue_Full'Address);
      end if;
   end Protected_Single_Entry_Call;

   function Protected_Count_Entry (Object : Protection_Entry) return Natural is
     (if Object.Waiting = null then 0 else 1);

   function Protected_Single_Entry_Caller (Object : Protection_Entry) return Task_Id is
     (To_Task (Object.In_Service));

end System.Tasking.Protected_Objects.Single_Entry;
