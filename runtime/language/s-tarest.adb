--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ravenbrick.Failures;
with Ravenbrick.Processor;
with Ravenbrick.Threads;

package body System.Tasking.Restricted.Stages is

   use Ravenbrick.Threads;

   Not_Activated : Natural := 0 with Volatile;
   --  Tasks of the chain being activated whose declarative part has not ended

   Activator : Thread_Id := null with Volatile;
   --  Waits for Not_Activated to become zero

   Sequential_Chain : Activation_Chain;

   Main_Priority : Integer := Unspecified_Priority
     with Export, Convention => C, External_Name => "__gl_main_priority";
   --  Written by the binder's code before any elaboration when the main procedure has a Priority

   procedure Create
     (Priority      : Integer;
      Stack_Address : System.Address;
      Stack_Size    : System.Parameters.Size_Type;
      State         : Task_Procedure_Access;
      Discriminants : System.Address;
      Elaborated    : not null Access_Boolean;
      Task_Image    : String;
      Created_Task  : not null Task_Id;
      Chain         : in out Activation_Chain);

   procedure Check_Elaborated (Created : not null Thread_Id);
   --  Program_Error when the task's body has not been elaborated (RM 3.11 (14)). Until the task
   --  starts, Entry_Parameters holds the address of the compiler's flag.

   procedure Activate (Chain : in out Activation_Chain);

   procedure Create
     (Priority      : Integer;
      Stack_Address : System.Address;
      Stack_Size    : System.Parameters.Size_Type;
      State         : Task_Procedure_Access;
      Discriminants : System.Address;
      Elaborated    : not null Access_Boolean;
      Task_Image    : String;
      Created_Task  : not null Task_Id;
      Chain         : in out Activation_Chain)
   is
      function To_Address is
        new Ada.Unchecked_Conversion (Task_Procedure_Access, System.Address);
      Created : constant not null Thread_Id := To_Thread (Created_Task);
   begin
      if Stack_Address = Null_Address then
         Ravenbrick.Failures.Stop (Ravenbrick.Failures.Stack_Not_Static'Address);
      end if;
      Create
        (Created    => Created,
         Priority   =>
           (if Priority = Unspecified_Priority then Kernel.Current.Base_Priority else Priority),
         Stack_Base => Stack_Address,
         Stack_Size => Natural (Stack_Size),
         Code       => To_Address (State),
         Argument   => Discriminants);
      Created.Name := Task_Image'Address;
      Created.Name_Length := Task_Image'Length;
      Created.Entry_Parameters := Elaborated.all'Address;
      Created.Next := To_Thread (Chain.T_ID);
      Chain.T_ID := Created_Task;
   end Create;

   procedure Create_Restricted_Task
     (Priority          : Integer;
      Stack_Address     : System.Address;
      Stack_Size        : System.Parameters.Size_Type;
      Sec_Stack_Address : System.Secondary_Stack.SS_Stack_Ptr;
      Sec_Stack_Size    : System.Parameters.Size_Type;
      Task_Info         : System.Task_Info.Task_Info_Type;
      CPU               : Integer;
      State             : Task_Procedure_Access;
      Discriminants     : System.Address;
      Elaborated        : Access_Boolean;
      Chain             : in out Activation_Chain;
      Task_Image        : String;
      Created_Task      : Task_Id)
   is
      pragma Unreferenced (Sec_Stack_Address, Sec_Stack_Size, Task_Info, CPU);
   begin
      Create
        (Priority, Stack_Address, Stack_Size, State, Discriminants, Elaborated, Task_Image,
         Created_Task, Chain);
   end Create_Restricted_Task;

   procedure Create_Restricted_Task_Sequential
     (Priority          : Integer;
      Stack_Address     : System.Address;
      Stack_Size        : System.Parameters.Size_Type;
      Sec_Stack_Address : System.Secondary_Stack.SS_Stack_Ptr;
      Sec_Stack_Size    : System.Parameters.Size_Type;
      Task_Info         : System.Task_Info.Task_Info_Type;
      CPU               : Integer;
      State             : Task_Procedure_Access;
      Discriminants     : System.Address;
      Elaborated        : Access_Boolean;
      Task_Image        : String;
      Created_Task      : Task_Id)
   is
      pragma Unreferenced (Sec_Stack_Address, Sec_Stack_Size, Task_Info, CPU);
   begin
      Create
        (Priority, Stack_Address, Stack_Size, State, Discriminants, Elaborated, Task_Image,
         Created_Task, Sequential_Chain);
   end Create_Restricted_Task_Sequential;

   procedure Check_Elaborated (Created : not null Thread_Id) is
      Elaborated : Boolean with Import, Address => Created.Entry_Parameters;
   begin
      if not Elaborated then
         Ravenbrick.Failures.Stop (Ravenbrick.Failures.Not_Elaborated'Address);
      end if;
   end Check_Elaborated;

   procedure Activate (Chain : in out Activation_Chain) is
      Self     : constant not null Thread_Id := Kernel.Current;
      Source   : Thread_Id := To_Thread (Chain.T_ID);
      First    : Thread_Id;
      Next     : Thread_Id;
      Caller   : Urgency;
   begin
      Chain.T_ID := null;

      --  Reverse the chain: tasks of one priority start in the order of their declarations

      while Source /= null loop
         Check_Elaborated (Source);
         Not_Activated := Not_Activated + 1;
         Next := Source.Next;
         Source.Next := First;
         First := Source;
         Source := Next;
      end loop;

      --  Above all tasks until all are ready, so that the most urgent one starts first

      Caller := Self.Active;
      Self.Active := To_Protected_Urgency (System.Priority'Last);
      while First /= null loop
         Next := First.Next;
         Ravenbrick.Processor.Mask_In_Thread;
         Make_Ready (First);
         Ravenbrick.Processor.Unmask_In_Thread;
         First := Next;
      end loop;

      Ravenbrick.Processor.Mask_In_Thread;
      Self.Active := Caller;
      if Not_Activated > 0 then
         Activator := Self;
         Self.State := Suspended;
         Block (Self);
      else
         Ravenbrick.Processor.Unmask_In_Thread;
      end if;
   end Activate;

   procedure Activate_Restricted_Tasks (Chain_Access : Activation_Chain_Access) is
   begin
      if Partition_Elaboration_Policy = 'C' then
         Activate (Chain_Access.all);
      end if;
   end Activate_Restricted_Tasks;

   procedure Activate_All_Tasks_Sequential is
   begin
      Activate (Sequential_Chain);
   end Activate_All_Tasks_Sequential;

   procedure Complete_Restricted_Activation is
      Waiting : Thread_Id;
   begin
      Ravenbrick.Processor.Mask_In_Thread;
      Not_Activated := Not_Activated - 1;
      Waiting := Activator;
      if Not_Activated = 0 and then Waiting /= null then
         Activator := null;
         Release (Kernel.Current, Waiting);
      else
         Ravenbrick.Processor.Unmask_In_Thread;
      end if;
   end Complete_Restricted_Activation;

   --  A task that ends violates No_Task_Termination; it stops to exist, as Ada RM D.13 allows, and
   --  only the fall-back handler, if there is one, and who looks at the threads see it

   procedure Complete_Restricted_Task is
   begin
      if At_Termination /= null then
         At_Termination.all;
      end if;
   end Complete_Restricted_Task;

   function Restricted_Terminated (T : Task_Id) return Boolean is
     (To_Thread (T).State = Terminated);

   procedure Finalize_Global_Tasks is
   begin
      Terminate_Current;
   end Finalize_Global_Tasks;

begin
   if Main_Priority /= Unspecified_Priority then
      Set_Environment_Priority (Main_Priority);
   end if;
end System.Tasking.Restricted.Stages;
