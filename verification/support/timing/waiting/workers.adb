--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts.Names;         use Ada.Interrupts.Names;
with Ada.Real_Time;                use Ada.Real_Time;
with Ada.Synchronous_Task_Control; use Ada.Synchronous_Task_Control;
with Interfaces;                   use Interfaces;
with System;

with Mixing; use Mixing;
with Timers;

package body Workers is

   use type Timers.Word;

   Epoch : constant Time := Clock + Milliseconds (20);

   Cue : Suspension_Object;

   Between : constant Timers.Word := 23_955;
   --  Counts of two cycles, a little less than a millisecond: all phases of the tasks are met

   type Turn is mod 6;

   protected Source with Interrupt_Priority => System.Interrupt_Priority'First + 4 is
      procedure Note with Attach_Handler => TC1;
   private
      Next : Turn := 0;
   end Source;

   protected body Source is
      procedure Note is
         Latency : constant Unsigned_32 := Unsigned_32 (Timers.Channel_1.Value);
      begin
         Timers.Acknowledge (Timers.Channel_1);
         if Latency < Shortest_Latency then
            Shortest_Latency := Latency;
         end if;
         if Latency > Longest_Latency then
            Longest_Latency := Latency;
         end if;
         if Next = 0 then
            Timers.Start_Stopwatch (Timers.Channel_2);
            Set_True (Cue);
         end if;
         Next := Next + 1;
      end Note;
   end Source;

   task body Control is
      Next : Time := Epoch;
   begin
      loop
         delay until Next;
         Mix (400);
         Next := Next + Milliseconds (4);
      end loop;
   end Control;

   task body Server is
      Response : Unsigned_32;
   begin
      Timers.Start_Cyclic (Timers.Channel_1, Between);
      loop
         Suspend_Until_True (Cue);
         Mix (200);
         delay until Clock + Microseconds (500);
         Mix (300);
         Response := Unsigned_32 (Timers.Channel_2.Value);
         if Response > Longest_Response then
            Longest_Response := Response;
         end if;
      end loop;
   end Server;

   task body Display is
      Next : Time := Epoch;
   begin
      loop
         delay until Next;
         Mix (20_000);
         Next := Next + Milliseconds (50);
      end loop;
   end Display;

end Workers;
