--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  What the compiler declares tasks with. A task's control block is a kernel thread.

with Ada.Unchecked_Conversion;

with Interfaces;

with System.Parameters;

with Ravenbrick.Threads;

package System.Tasking is
   pragma Preelaborate;

   Null_Entry : constant := 0;
   Max_Entry  : constant := Integer'Last;

   type Entry_Index is range -2 .. Max_Entry;

   Null_Task_Entry : constant := Null_Entry;
   Max_Task_Entry  : constant := 2 ** 15 - 1;
   --  The profiles have none

   type Task_Entry_Index is new Entry_Index range Null_Task_Entry .. Max_Task_Entry;

   type Call_Modes is (Simple_Call, Conditional_Call, Asynchronous_Call, Timed_Call);
   --  The profiles have simple calls of entries only

   type Ada_Task_Control_Block (Entry_Num : Task_Entry_Index) is limited record
      Thread     : aliased Ravenbrick.Threads.Thread;
      Ticks_High : Interfaces.Unsigned_16;
      Ticks_Low  : Interfaces.Unsigned_32;
   end record
     with Size => 64 * 8, Alignment => 8;
   for Ada_Task_Control_Block use record
      Thread     at 0  range 0 .. 56 * 8 - 1;
      Entry_Num  at 56 range 0 .. 15;
      Ticks_High at 58 range 0 .. 15;
      Ticks_Low  at 60 range 0 .. 31;
   end record;
   --  Entry_Num is always 0. Address and layout are the thread's, so that a Task_Id converts to
   --  a Thread_Id. The ticks are the execution time (arm7tdmi/charge.h).

   type Task_Id is access all Ada_Task_Control_Block;

   Null_Task : constant Task_Id := null;

   function To_Thread is
     new Ada.Unchecked_Conversion (Task_Id, Ravenbrick.Threads.Thread_Id);
   function To_Task is
     new Ada.Unchecked_Conversion (Ravenbrick.Threads.Thread_Id, Task_Id);

   function Self return Task_Id is (To_Task (Ravenbrick.Threads.Kernel.Current))
     with Volatile_Function;
   --  The running task

   function Storage_Size (T : Task_Id) return System.Parameters.Size_Type is
     (System.Parameters.Size_Type (To_Thread (T).Stack_Size));
   --  What the attribute of a task gives

   type Termination_Hook is access procedure;

   At_Termination : Termination_Hook := null;
   --  Called by each task at the end of its body; set by Ada.Task_Termination

   type Task_Procedure_Access is access procedure (Discriminants : Address);
   pragma Favor_Top_Level (Task_Procedure_Access);

   type Access_Boolean is access all Boolean;

   type Activation_Chain is limited record
      T_ID : Task_Id;
   end record;
   pragma Volatile (Activation_Chain);
   --  Tasks created by one declarative part, latest first, linked as in a queue

   type Activation_Chain_Access is access all Activation_Chain;

   subtype Master_Level is Integer;
   subtype Master_ID is Master_Level;

   Foreign_Task_Level     : constant Master_Level := 0;
   Environment_Task_Level : constant Master_Level := 1;
   Independent_Task_Level : constant Master_Level := 2;
   Library_Task_Level     : constant Master_Level := 3;

   Unspecified_Priority : constant Integer := -1;
   Unspecified_CPU      : constant := -1;

end System.Tasking;
