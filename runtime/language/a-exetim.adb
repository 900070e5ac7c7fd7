--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Unchecked_Conversion;

with System.Tasking;

with Ravenbrick.Execution_Times;
with Ravenbrick.Failures;

package body Ada.Execution_Time is

   use Ada.Real_Time;

   pragma Unsuppress (Overflow_Check);
   pragma Unsuppress (Range_Check);
   --  An unrepresentable result raises Constraint_Error, as for predefined arithmetic

   subtype Wide is Long_Long_Integer;

   function To_Wide is new Ada.Unchecked_Conversion (Time_Span, Wide);
   function To_Span is new Ada.Unchecked_Conversion (Wide, Time_Span);
   --  A Time_Span counts the same units

   function To_Task is new Ada.Unchecked_Conversion
     (Ada.Task_Identification.Task_Id, System.Tasking.Task_Id);

   function Clock
     (T : Ada.Task_Identification.Task_Id := Ada.Task_Identification.Current_Task)
      return CPU_Time is
   begin
      if Ada.Task_Identification.Is_Terminated (T) then
         Ravenbrick.Failures.Stop (Ravenbrick.Failures.Task_Terminated'Address);
      end if;
      return CPU_Time
        (Ravenbrick.Execution_Times.Of_Thread (System.Tasking.To_Thread (To_Task (T))));
   end Clock;

   function "+" (Left : CPU_Time; Right : Time_Span) return CPU_Time is
     (CPU_Time (Wide (Left) + To_Wide (Right)));
   function "+" (Left : Time_Span; Right : CPU_Time) return CPU_Time is
     (CPU_Time (To_Wide (Left) + Wide (Right)));
   function "-" (Left : CPU_Time; Right : Time_Span) return CPU_Time is
     (CPU_Time (Wide (Left) - To_Wide (Right)));
   function "-" (Left : CPU_Time; Right : CPU_Time) return Time_Span is
     (To_Span (Wide (Left) - Wide (Right)));

   procedure Split (T : CPU_Time; SC : out Seconds_Count; TS : out Time_Span) is
   begin
      Split (Ada.Real_Time.Time_Of (0, To_Span (Wide (T))), SC, TS);
   end Split;

   function Time_Of
     (SC : Seconds_Count; TS : Time_Span := Time_Span_Zero) return CPU_Time is
     (CPU_Time (Wide (SC) * Units_Per_Second + To_Wide (TS)));

   function Clock_For_Interrupts return CPU_Time is
     (CPU_Time (Ravenbrick.Execution_Times.Of_Interrupts));

end Ada.Execution_Time;
