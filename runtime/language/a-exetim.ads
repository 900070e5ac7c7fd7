--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Execution time (Ada RM D.14). A task is charged for its own code and for the run-time's services
--  that it calls; an interrupt handler has a clock of its own, so that it costs no task anything.
--  The kernel counts only in programs that are linked with EXECUTION_TIME=yes; others cannot use
--  this package: they do not link.

with Ada.Real_Time;
with Ada.Task_Identification;

private with Ravenbrick.Threads;

package Ada.Execution_Time is

   type CPU_Time is private;

   CPU_Time_First : constant CPU_Time;
   CPU_Time_Last  : constant CPU_Time;
   CPU_Time_Unit  : constant := Ada.Real_Time.Time_Unit;
   CPU_Tick       : constant Ada.Real_Time.Time_Span;

   function Clock
     (T : Ada.Task_Identification.Task_Id := Ada.Task_Identification.Current_Task)
      return CPU_Time
     with Volatile_Function;
   --  What T has executed until now. Program_Error for Null_Task_Id, Tasking_Error when T has
   --  terminated.

   function "+" (Left : CPU_Time; Right : Ada.Real_Time.Time_Span) return CPU_Time;
   function "+" (Left : Ada.Real_Time.Time_Span; Right : CPU_Time) return CPU_Time;
   function "-" (Left : CPU_Time; Right : Ada.Real_Time.Time_Span) return CPU_Time;
   function "-" (Left : CPU_Time; Right : CPU_Time) return Ada.Real_Time.Time_Span;

   function "<"  (Left, Right : CPU_Time) return Boolean;
   function "<=" (Left, Right : CPU_Time) return Boolean;
   function ">"  (Left, Right : CPU_Time) return Boolean;
   function ">=" (Left, Right : CPU_Time) return Boolean;

   procedure Split
     (T  : CPU_Time;
      SC : out Ada.Real_Time.Seconds_Count;
      TS : out Ada.Real_Time.Time_Span);

   function Time_Of
     (SC : Ada.Real_Time.Seconds_Count;
      TS : Ada.Real_Time.Time_Span := Ada.Real_Time.Time_Span_Zero)
      return CPU_Time;

   Interrupt_Clocks_Supported          : constant Boolean := True;
   Separate_Interrupt_Clocks_Supported : constant Boolean := True;

   function Clock_For_Interrupts return CPU_Time with Volatile_Function;
   --  All handlers together

private

   type CPU_Time is new Ravenbrick.Threads.Units;

   CPU_Time_First : constant CPU_Time := 0;
   CPU_Time_Last  : constant CPU_Time := CPU_Time'Last;
   CPU_Tick       : constant Ada.Real_Time.Time_Span := Ada.Real_Time.Tick;

   pragma Import (Intrinsic, "<");
   pragma Import (Intrinsic, "<=");
   pragma Import (Intrinsic, ">");
   pragma Import (Intrinsic, ">=");

end Ada.Execution_Time;
