--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ravenbrick.Entry_Queues;
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

   procedure Check_Room
     (Object : not null Protection_Entries_Access; E : Protected_Entry_Index);
   --  Program_Error when the queue of E has its Max_Queue_Length

   procedure Wait (Object : not null Protection_Entries_Access; E : Protected_Entry_Index);
   --  Put the caller into the queue of E, serve, leave the object and block until the entry has
   --  been executed

   function Selected (Object : not null Protection_Entries_Access) return Protected_Entry_Index;
   --  The open entry that is to be served next, Null_Protected_Entry when there is none

   procedure Take_First
     (Object : not null Protection_Entries_Access;
      E      : Protected_Entry_Index;
      Caller : out Thread_Id);
   --  Execute E, which is open, for the first of its queue, which is not empty

   procedure Serve (Object : not null Protection_Entries_Access; Served : out Boolean);
   --  Execute open entries until there are none; Served: the running thread's own call was among
   --  them

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

   procedure Check_Room
     (Object : not null Protection_Entries_Access; E : Protected_Entry_Index) is
   begin
      if Object.Maxima /= null
        and then Object.Maxima (E) /= 0
        and then Object.Queues (E).Length >= Object.Maxima (E)
      then
         Ravenbrick.Failures.Stop (Ravenbrick.Failures.Longest_Queue'Address);
      end if;
   end Check_Room;

   --  The new call may have opened an entry whose barrier asks for 'Count, even its own

   procedure Wait (Object : not null Protection_Entries_Access; E : Protected_Entry_Index) is
      Self   : constant not null Thread_Id := Kernel.Current;
      Served : Boolean;
   begin
      Check_Room (Object, E);
      Ravenbrick.Entry_Queues.Insert (Object.Queues (E), Self);
      Serve (Object, Served);
      if Served then
         Unlock (Object.Common'Access);
      else
         Ravenbrick.Processor.Mask_In_Thread;
         Leave (Object.Common'Access);
         Self.State := Blocked_On_Entry;
         Block (Self);
      end if;
   end Wait;

   function Selected (Object : not null Protection_Entries_Access) return Protected_Entry_Index is
      Result : Protected_Entry_Index := Null_Protected_Entry;
   begin
      for E in 1 .. Object.Num_Entries loop
         if Object.Queues (E).Length > 0
           and then (Result = Null_Protected_Entry
                     or else Ravenbrick.Entry_Queues.Outranks
                       (Object.Queues (E).First, Object.Queues (Result).First))
           and then Is_Open (Object, E)
         then
            Result := E;
         end if;
      end loop;
      return Result;
   end Selected;

   procedure Take_First
     (Object : not null Protection_Entries_Access;
      E      : Protected_Entry_Index;
      Caller : out Thread_Id)
   is
      Queue : Ravenbrick.Entry_Queues.Queue renames Object.Queues (E);
   begin
      Caller := Queue.First;
      Queue.First := Caller.Next;
      Queue.Length := Queue.Length - 1;
      Execute (Object, E, Caller, Caller.Entry_Parameters);
   end Take_First;

   --  After each body all barriers are looked at again (RM 9.5.3 (12..14)): it may have changed any
   --  of them. Each turn takes a task out of a queue and none can join.

   procedure Serve (Object : not null Protection_Entries_Access; Served : out Boolean) is
      E        : Protected_Entry_Index;
      Caller   : Thread_Id;
      Previous : Ravenbrick.Processor.Status;
   begin
      Served := False;
      loop
         E := Selected (Object);
         exit when E = Null_Protected_Entry;
         Take_First (Object, E, Caller);
         if Caller = Kernel.Current then
            Served := True;
         else
            Ravenbrick.Processor.Mask_Interrupts (Previous);
            Make_Ready (Caller);
            Ravenbrick.Processor.Restore_Interrupts (Previous);
         end if;
      end loop;
   end Serve;

   procedure Service_Entries (Object : Protection_Entries_Access) is
      Served : Boolean;
   begin
      Serve (Object, Served);
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
