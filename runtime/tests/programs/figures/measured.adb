--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts.Names; use Ada.Interrupts.Names;
with Ada.Real_Time; use Ada.Real_Time;
with Ada.Synchronous_Task_Control; use Ada.Synchronous_Task_Control;
with System;

with Timers; use Timers;

package body Measured is

   use type Figure;

   Calls : constant := 100;

   Released : Suspension_Object;
   Served   : Suspension_Object;

   At_Handler : Word := 0 with Volatile;
   --  Cyclic timer at the first statement of its interrupt's handler

   Started_At : Figure := 0 with Volatile;
   --  Stopwatch when the measured action began

   function Stopwatch return Figure is (Figure (Channel_2.Value)) with Inline;

   function Since (Start : Figure) return Figure is
     (2 * ((Stopwatch - Start) and 16#FFFF#)) with Inline;
   --  Cycles

   protected Object with Priority => 20 is
      procedure Touch;
   private
      Count : Natural := 0;
   end Object;

   protected Gate with Priority => 20 is
      procedure Open;
      entry Pass;
   private
      Is_Open : Boolean := False;
   end Gate;

   protected Source with Interrupt_Priority => System.Interrupt_Priority'First + 4 is
      procedure Handle with Attach_Handler => TC1;
   end Source;

   protected body Object is
      procedure Touch is
      begin
         Count := Count + 1;
      end Touch;
   end Object;

   protected body Gate is

      procedure Open is
      begin
         Is_Open := True;
      end Open;

      entry Pass when Is_Open is
      begin
         Is_Open := False;
      end Pass;

   end Gate;

   protected body Source is
      procedure Handle is
      begin
         At_Handler := Channel_1.Value;
         Acknowledge (Channel_1);
         Set_True (Served);
      end Handle;
   end Source;

   Plain : Natural := 0 with Volatile;

   procedure Touch_Plain with No_Inline;

   procedure Touch_Plain is
   begin
      Plain := Plain + 1;
   end Touch_Plain;

   procedure Measure_Protected_Calls is
      Start : Figure;
      Empty : Figure;
   begin
      Start := Stopwatch;
      for Call in 1 .. Calls loop
         Touch_Plain;
      end loop;
      Empty := Since (Start);
      Start := Stopwatch;
      for Call in 1 .. Calls loop
         Object.Touch;
      end loop;
      Results.Protected_Call := Since (Start) - Empty;
   end Measure_Protected_Calls;

   task body Low is
      Start : Figure;
      Now   : Figure;
   begin
      delay until Time_Of (0, Milliseconds (2));
      Start_Stopwatch (Channel_2);
      Start := Stopwatch;
      Results.Stopwatch := Since (Start);
      Measure_Protected_Calls;

      for Turn in 1 .. 3 loop
         Start := Stopwatch;
         Set_True (Released);
         Now := Stopwatch;
         Results.Round_Trip := 2 * ((Now - Start) and 16#FFFF#);
         Results.Suspend_To_Next := 2 * ((Now - Started_At) and 16#FFFF#);
      end loop;

      for Turn in 1 .. 3 loop
         Started_At := Stopwatch;
         Gate.Open;
      end loop;

      Start_Cyclic (Channel_1, 20_003);
      loop
         Touch_Plain;
      end loop;
   end Low;

   task body High is
   begin
      loop
         Started_At := Stopwatch;
         Suspend_Until_True (Released);
      end loop;
   end High;

   task body Waiting is
   begin
      loop
         Gate.Pass;
         Results.Entry_Opened := Since (Started_At);
      end loop;
   end Waiting;

   task body Server is
      Passed : Figure;
   begin
      loop
         Suspend_Until_True (Served);
         Passed := 2 * Figure (Channel_1.Value);
         Results.To_Task := Passed;
         Results.To_Handler := 2 * Figure (At_Handler);
         Results.To_Handler_Max := Figure'Max (Results.To_Handler_Max, Results.To_Handler);
         Results.Interrupts := Results.Interrupts + 1;
         Results.To_Task_Max := Figure'Max (Results.To_Task_Max, Passed);
      end loop;
   end Server;

end Measured;
