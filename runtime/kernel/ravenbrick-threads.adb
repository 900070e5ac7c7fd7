--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ravenbrick.Accounting;
with Ravenbrick.Processor;

package body Ravenbrick.Threads is

   Environment_Name : constant String := "environment";

   Environment_Stack : Storage_Element
     with Import, Convention => C, External_Name => "ravenbrick_environment_stack";
   Environment_Stack_Size : Storage_Element
     with Import, Convention => C, External_Name => "ravenbrick_environment_stack_size";
   --  The address is the value: symbols of the linker script

   type First_Context is array (1 .. 3) of System.Address;
   --  What Processor.Thread_Start finds on the stack: its own address, argument and code

   procedure Record_Created (Created : not null Thread_Id)
     with Post => Kernel.First_Created = Created;

   procedure Switch (Self, To : not null Thread_Id)
     with Inline_Always;
   --  Give the processor to To

   procedure Insert_First (Preempted : not null Thread_Id; Rank : Urgency)
     with Inline,
          Pre  => Interrupts_Masked and then Preempted.State = Ready,
          Post => Kernel.Ready_Head.Active >= Rank;
   --  Put a thread whose urgency is Rank before its equals (RM D.2.3 (10))

   procedure Record_Created (Created : not null Thread_Id) is
   begin
      Created.Next_Created := Kernel.First_Created;
      Kernel.First_Created := Created;
   end Record_Created;

   procedure Initialize is
      Self : constant not null Thread_Id := Environment'Access;
   begin
      Kernel.Idle.Active := -1;
      Kernel.Sentinel.Active := -1;
      Kernel.Ready_Head := Kernel.Sentinel'Access;
      Set_Environment_Priority (System.Default_Priority);
      Self.Name := Environment_Name'Address;
      Self.Name_Length := Environment_Name'Length;
      Self.Stack_Base := Environment_Stack'Address;
      Self.Stack_Size := Natural (To_Integer (Environment_Stack_Size'Address));
      Record_Created (Self);
      Self.State := Ready;
      Kernel.Current := Self;
      Kernel.Running := Self;
   end Initialize;

   procedure Set_Environment_Priority (Priority : System.Any_Priority) is
   begin
      Environment.Base_Priority := Priority;
      Environment.Active := To_Urgency (Priority);
   end Set_Environment_Priority;

   procedure Create
     (Created    : not null Thread_Id;
      Priority   : System.Any_Priority;
      Stack_Base : System.Address;
      Stack_Size : Natural;
      Code       : System.Address;
      Argument   : System.Address)
   is
      Word : constant := 4;
      Top  : constant System.Address :=
        To_Address ((To_Integer (Stack_Base) + Integer_Address (Stack_Size)) / 8 * 8);
      Bottom : constant System.Address := Top - Storage_Offset (First_Context'Length * Word);
      First  : First_Context with Import, Address => Bottom;
   begin
      First := (Processor.Thread_Start'Address, Argument, Code);
      Created.Stack_Pointer := Bottom;
      Created.Base_Priority := Priority;
      Created.Active := To_Urgency (Priority);
      Created.Stack_Base := Stack_Base;
      Created.Stack_Size := Stack_Size;
      Created.State := Unstarted;
      Record_Created (Created);
   end Create;

   procedure Switch (Self, To : not null Thread_Id) is
   begin
      pragma Assert (Interrupts_Masked and then Self /= To and then To.State = Ready);
      Accounting.Charge;
      Processor.Switch (Self, To);
   end Switch;

   procedure Make_Ready (Woken : not null Thread_Id) is
      Rank     : constant Urgency := Woken.Active;
      Previous : Thread_Id := Kernel.Ready_Head;
      Follower : Thread_Id;
   begin
      if Previous.Active < Rank then
         Woken.Next := Previous;
         Kernel.Ready_Head := Woken;
      else
         loop
            Follower := Previous.Next;
            exit when Follower.Active < Rank;
            Previous := Follower;
         end loop;
         Woken.Next := Follower;
         Previous.Next := Woken;
      end if;
      Woken.State := Ready;
   end Make_Ready;

   procedure Insert_First (Preempted : not null Thread_Id; Rank : Urgency) is
      Previous : Thread_Id := Kernel.Ready_Head;
      Follower : Thread_Id;
   begin
      if Previous.Active <= Rank then
         Preempted.Next := Previous;
         Kernel.Ready_Head := Preempted;
      else
         loop
            Follower := Previous.Next;
            exit when Follower.Active <= Rank;
            Previous := Follower;
         end loop;
         Preempted.Next := Follower;
         Previous.Next := Preempted;
      end if;
   end Insert_First;

   --  The caller is at least as urgent as the head of the queue, or it would not run

   procedure Release (Self, Woken : not null Thread_Id) is
   begin
      if Woken.Active > Self.Active then
         Woken.State := Ready;
         Self.Next := Kernel.Ready_Head;
         Kernel.Ready_Head := Self;
         Switch (Self, Woken);
      else
         Make_Ready (Woken);
         Processor.Unmask_In_Thread;
      end if;
   end Release;

   procedure Block (Self : not null Thread_Id) is
      Next : constant not null Thread_Id := Kernel.Ready_Head;
   begin
      if Next /= Kernel.Sentinel'Access then
         Kernel.Ready_Head := Next.Next;
         Switch (Self, Next);
      else
         Accounting.Charge;
         Processor.Switch_To_Idle (Self);
      end if;
   end Block;

   procedure Preempt is
      Self : constant not null Thread_Id := Kernel.Current;
      Next : constant not null Thread_Id := Kernel.Ready_Head;
      Rank : constant Urgency := Self.Active;
   begin
      if Next.Active > Rank then
         Kernel.Ready_Head := Next.Next;
         Insert_First (Self, Rank);
         Switch (Self, Next);
      else
         Processor.Unmask_In_Thread;
      end if;
   end Preempt;

   procedure Yield (Self : not null Thread_Id) is
      Next : constant not null Thread_Id := Kernel.Ready_Head;
   begin
      if Next.Active >= Self.Active then
         Kernel.Ready_Head := Next.Next;
         Make_Ready (Self);
         Switch (Self, Next);
      else
         Processor.Unmask_In_Thread;
      end if;
   end Yield;

   procedure Terminate_Current is
   begin
      Processor.Mask_In_Thread;
      Kernel.Current.State := Terminated;
      Block (Kernel.Current);
      raise Program_Error;
   end Terminate_Current;

end Ravenbrick.Threads;
