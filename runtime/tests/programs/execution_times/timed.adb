--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Execution_Time.Interrupts; use Ada.Execution_Time;
with Ada.Interrupts.Names; use Ada.Interrupts.Names;
with Ada.Real_Time; use Ada.Real_Time;
with Ada.Task_Identification; use Ada.Task_Identification;
with System;

with Timers; use Timers;

package body Timed is

   protected Source with Interrupt_Priority => System.Interrupt_Priority'Last is
      procedure Handle with Attach_Handler => TC1;
   private
      Requests : Natural := 0;
   end Source;

   function Spent (Item : CPU_Time) return Long_Long_Integer is
     (Long_Long_Integer ((Item - CPU_Time_First) / Time_Span_Unit));

   procedure Spin (Rounds : Positive) with No_Inline;

   procedure Spin (Rounds : Positive) is
      Product : Natural := 1 with Volatile;
   begin
      for Round in 1 .. Rounds loop
         Product := (Product * 3) mod 8_191;
      end loop;
   end Spin;

   protected body Source is
      procedure Handle is
      begin
         Acknowledge (Channel_1);
         Requests := Requests + 1;
         Spin (20);
      end Handle;
   end Source;

   procedure Note_Job (Processor_Time, Wall_Time : Long_Long_Integer) is
   begin
      if Jobs = 0 or else Processor_Time < Own (1) then
         Own (1) := Processor_Time;
      end if;
      Own (2) := Long_Long_Integer'Max (Own (2), Processor_Time);
      if Jobs = 0 or else Wall_Time < Own (3) then
         Own (3) := Wall_Time;
      end if;
      Own (4) := Long_Long_Integer'Max (Own (4), Wall_Time);
      Jobs := Jobs + 1;
   end Note_Job;

   task body Quick is
      Next      : Time := Time_Of (0, Milliseconds (5));
      Processor : CPU_Time;
      Wall      : Time;
   begin
      Start_Cyclic (Channel_1, 9_973);
      loop
         delay until Next;
         Next := Next + Microseconds (1_000);
         Processor := Clock;
         Wall := Clock;
         Spin (100);
         Note_Job
           (Long_Long_Integer ((Clock - Processor) / Time_Span_Unit),
            Long_Long_Integer ((Clock - Wall) / Time_Span_Unit));
      end loop;
   end Quick;

   task body Slow is
      Next : Time := Time_Of (0, Milliseconds (6));
   begin
      loop
         delay until Next;
         Next := Next + Milliseconds (10);
         Spin (3_000);
      end loop;
   end Slow;

   procedure Work is
   begin
      loop
         Spin (50);
         Clocks :=
           (Spent (Clock (Quick'Identity)),
            Spent (Clock (Slow'Identity)),
            Spent (Clock (Environment_Task)),
            Spent (Interrupts.Clock (TC1)),
            Spent (Interrupts.Clock (TC0)),
            Spent (Clock_For_Interrupts));
      end loop;
   end Work;

end Timed;
