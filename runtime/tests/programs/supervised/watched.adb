--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;                use Ada.Real_Time;
with Ada.Synchronous_Task_Control; use Ada.Synchronous_Task_Control;
with System.Storage_Elements;      use System.Storage_Elements;

with Ravenbrick.Supervision;
with Ravenbrick.Threads;

package body Watched is

   Period      : constant Time_Span := Milliseconds (10);
   Deadline    : constant Time_Span := Milliseconds (5);
   Wrong_After : constant := 20;
   Wrong_Every : constant := 10;

   Released : Suspension_Object;

   function Is_Chosen (Item : Fault) return Boolean is (Chosen = Fault'Pos (Item));

   procedure Work (Until_Time : Time) is
   begin
      while Clock < Until_Time loop
         null;
      end loop;
   end Work;

   procedure Overwrite_Lowest_Word is
      Base   : constant Integer_Address :=
        To_Integer (Ravenbrick.Threads.Kernel.Current.Stack_Base);
      Lowest : Integer with Import, Volatile, Address => To_Address ((Base + 3) / 4 * 4);
   begin
      Lowest := 1;
   end Overwrite_Lowest_Word;

   task body Supervisor is
      Step_Ms : constant := 2;
      Next    : Time     := Clock;
      Checks  : Natural  := 0;
   begin
      loop
         Next := Next + Milliseconds (Step_Ms);
         delay until Next;
         Ravenbrick.Supervision.Check (Step_Ms);
         Checks := Checks + 1;
         if Is_Chosen (Hangs) and then Checks = Wrong_After then
            Work (Time_Last);
         end if;
      end loop;
   end Supervisor;

   task body Sporadic is
      Jobs : Natural := 0;
   begin
      loop
         Suspend_Until_True (Released);
         Jobs := Jobs + 1;
         Work
           (if Is_Chosen (Late_Sporadic) and then Jobs = Wrong_After then Time_Last
            else Clock + Milliseconds (3));
      end loop;
   end Sporadic;

   task body Cyclic is
      Next : Time    := Clock;
      Jobs : Natural := 0;
   begin
      if Is_Chosen (No_Delay) then
         Work (Time_Last);
      end if;
      loop
         Next := Next + Period;
         delay until Next;
         Jobs := Jobs + 1;
         if not (Is_Chosen (Often_Late) or else Is_Chosen (Seldom_Late)) then
            Set_True (Released);
         end if;
         if Is_Chosen (Often_Late) and then Jobs mod Wrong_Every = 0 then
            Work (Next + Deadline + Microseconds (9_900));
         elsif Is_Chosen (Seldom_Late) and then Jobs mod Wrong_Every = 0 then
            Work (Next + Deadline + Microseconds (7_900));
         elsif Is_Chosen (Late) and then Jobs = Wrong_After then
            Work (Time_Last);
         elsif Is_Chosen (Behind) then
            Work (Clock + Period + Milliseconds (2));
         elsif Is_Chosen (Overflows) and then Jobs = Wrong_After then
            Overwrite_Lowest_Word;
         end if;
         exit when Is_Chosen (Ends) and then Jobs = Wrong_After;
      end loop;
   end Cyclic;

end Watched;
