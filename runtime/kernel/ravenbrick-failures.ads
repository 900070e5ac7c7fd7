--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The end of a program that violates a rule which only the run-time can check. The text takes
--  the place of the file name that the compiler's own checks report.

with System;

package Ravenbrick.Failures is
   pragma Preelaborate;

   procedure Stop (Text : System.Address; Line : Integer := 0)
     with Import, Convention => C, External_Name => "__gnat_last_chance_handler", No_Return;
   --  Tell the application's hook, then halt with interrupts masked. Text ends with NUL.

   type Failure is record
      Text     : System.Address;
      Line     : Integer;
      Current  : System.Address;
      Object   : System.Address;
      Reported : Integer;
   end record
     with Volatile, Convention => C, Suppress_Initialization;
   --  Text is null while the program has not failed. Current: the thread that failed, or the
   --  handler as Ravenbrick.Interrupts has it. Object: of a ceiling violation, otherwise null.
   --  Reported: 1 when the application's hook has returned, until then 0.

   Latest : Failure with Import, Convention => C, External_Name => "ravenbrick_failure";

   Longest_Text : constant := 63;

   procedure Stop_With (Text : String; Line : Natural)
     with No_Return,
          Global => (Output => Latest),
          Pre    => Text'First >= 1;
   --  The same with a text of the program, cut to Longest_Text

   Ceiling_Violated : constant String := "Program_Error: ceiling violated" & ASCII.NUL;
   --  RM D.3 (13)

   Blocking : constant String := "Program_Error: blocking in protected action" & ASCII.NUL;
   --  RM 9.5.1 (8), detected as pragma Detect_Blocking asks for

   Entry_Queue_Full : constant String := "Program_Error: second caller of entry" & ASCII.NUL;
   --  Max_Entry_Queue_Length => 1, RM D.7

   Longest_Queue : constant String := "Program_Error: entry queue at its maximum" & ASCII.NUL;
   --  Max_Queue_Length, RM D.4 (15.d)

   Second_Suspended : constant String := "Program_Error: second task suspended" & ASCII.NUL;
   --  RM D.10 (10)

   Not_Elaborated : constant String := "Program_Error: task body not elaborated" & ASCII.NUL;
   --  RM 3.11 (14)

   Interrupt_Taken : constant String := "Program_Error: interrupt reserved or taken" & ASCII.NUL;
   --  RM C.3.1 (10)

   Task_Terminated : constant String := "Tasking_Error: task terminated" & ASCII.NUL;
   --  RM D.14 (17)

   Null_Task_Id : constant String := "Program_Error: null task id" & ASCII.NUL;
   --  RM C.7.1 (15)

   No_Secondary_Stack : constant String := "Storage_Error: no secondary stack" & ASCII.NUL;
   Secondary_Stack_Full : constant String := "Storage_Error: secondary stack full" & ASCII.NUL;
   Heap_Full : constant String := "Storage_Error: heap full" & ASCII.NUL;
   Pool_Full : constant String := "Storage_Error: storage pool full" & ASCII.NUL;
   Stack_Not_Static : constant String := "Storage_Error: task stack not static" & ASCII.NUL;

end Ravenbrick.Failures;
