--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ravenbrick.Failures;
with Ravenbrick.Processor;

package body System.Tasking.Protected_Objects.Operations is

   use Entries;
   use Ravenbrick.Threads;

   function Is_Open
     (Object : not null Protection_Entries_Access; E : Protected_Entry_Index) return Boolean
     with Inline;

   procedure Execute
     (Object     : not null Protection_Entries_Access;
      E          : Protected_Entry_Index;
      Caller     : not null Thread_Id;
      Parameters : System.Address)
     with Inline;

   procedure Wait (Object : not null Protection_Entries_Access; E : Protected_Entry_Index);
   --  Append the caller to the queue of E, leave the object and block until the entry has been
   --  executed

   procedure Serve_First
     (Object : not null Protection_Entries_Access; E : Protected_Entry_Index);
   --  Execute E, which is open, for the first of its queue, which is not empty

   function Is_Open
     (Object : not null Protection_Entries_Access; E : Protected_Entry_Index) return Boolean
   is
     (Object.Bodies (Object.Body_Index (Object.Info, E)).Barrier (Object.Info, E));

   procedure Execute
     (Object     : not null Protection_Entries_Access;
      E          : Protected_Entry_Index;
      Caller     : not null Thread_Id;
      Parameters : System.Address) is
   begin
      Object.In_Service := Caller;
      Object.Bodies (Object.Body_Index (Object.Info, E)).Action (Object.Info, Parameters, E);
      Object.In_Service := null;
   end Execute;

   procedure Wait (Object : not null Protection_Entries_Access; E : Protected_Entry_Index) is
      Self  : constant not null Thread_Id := Kernel.Current;
      Queue : Entry_Queue renames Object.Queues (E);
   begin
      if Object.Maxima /= null
        and then Object.Maxima (E) /= 0
        and then Queue.Length >= Object.Maxima (E)
      then
         Ravenbrick.Failures.Stop (Ravenbrick.Failures.Longest_Queue'Address);
      end if;
      if Queue.Length = 0 then
         Queue.First := Self;
      else
         Queue.Last.Next := Self;
      end if;
      Queue.Last := Self;
      Queue.Length := Queue.Length + 1;
      Ravenbrick.Processor.Mask_In_Thread;
      Leave (Object.Common'Access);
      Self.State := Blocked_On_Entry;
      Block (Self);
   end Wait;

   procedure Serve_First
     (Object : not null Protection_Entries_Access; E : Protected_Entry_Index)
   is
      Queue    : Entry_Queue renames Object.Queues (E);
      Caller   : constant not null Thread_Id := Queue.First;
      Previous : Ravenbrick.Processor.Status;
   begin
      Queue.First := Caller.Next;
      Queue.Length := Queue.Length - 1;
      Execute (Object, E, Caller, Caller.Entry_Parameters);
      Ravenbrick.Processor.Mask_Interrupts (Previous);
      Make_Ready (Caller);
      Ravenbrick.Processor.Restore_Interrupts (Previous);
   end Serve_First;

   --  After each body all barriers are looked at again, from the first on (RM 9.5.3 (12..14)): it
   --  may have changed any of them. Each turn takes a task out of a queue and none can join.

   procedure Service_Entries (Object : Protection_Entries_Access) is
      E : Protected_Entry_Index := 1;
   begin
      while E <= Object.Num_Entries loop
         if Object.Queues (E).Length > 0 and then Is_Open (Object, E) then
            Serve_First (Object, E);
            E := 1;
         else
            E := E + 1;
         end if;
      end loop;
      Unlock (Object.Common'Access);
   end Service_Entries;

   procedure Protected_Entry_Call
     (Object             : Protection_Entries_Access;
      E                  : Protected_Entry_Index;
      Uninterpreted_Data : System.Address;
      Mode               : Call_Modes;
      Block              : out Communication_Block)
   is
      pragma Unreferenced (Mode, Block);
      Self : constant not null Thread_Id := Kernel.Current;
   begin
      if In_Protected_Action (Self.Active) then
         Ravenbrick.Failures.Stop (Ravenbrick.Failures.Blocking'Address);
      end if;
      Lock (Object.Common'Access);
      if Is_Open (Object, E) then
         Execute (Object, E, Self, Uninterpreted_Data);
         Service_Entries (Object);
      else
         Self.Entry_Parameters := Uninterpreted_Data;
         Wait (Object, E);
      end if;
   end Protected_Entry_Call;

   function Protected_Count
     (Object : Protection_Entries; E : Protected_Entry_Index) return Natural
   is
     (Object.Queues (E).Length);

   function Protected_Entry_Caller (Object : Protection_Entries) return Task_Id is
     (To_Task (Object.In_Service));

end System.Tasking.Protected_Objects.Operations;
