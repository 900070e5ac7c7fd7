--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts.Names; use Ada.Interrupts.Names;
with Ada.Real_Time; use Ada.Real_Time;
with Ada.Synchronous_Task_Control; use Ada.Synchronous_Task_Control;

with Interfaces; use Interfaces;

with Timers; use Timers;

package body Measured_Services is

   Released : Suspension_Object;
   Served   : Suspension_Object;

   Started_At   : Cycles := 0 with Volatile;
   Suspended_At : Cycles := 0 with Volatile;
   Plain        : Unsigned_32 := 0 with Volatile;

   function Stopwatch return Cycles is (Cycles (Channel_2.Value)) with Inline;

   function Since (Start : Cycles) return Cycles is
     (2 * ((Stopwatch - Start) and 16#FFFF#)) with Inline;

   protected Object with Priority => 20 is
      procedure Touch;
   private
      Count : Unsigned_32 := 0;
   end Object;

   protected Gate with Priority => 20 is
      procedure Open;
      entry Pass;
   private
      Is_Open : Boolean := False;
   end Gate;

   protected Always with Priority => 20 is
      entry Pass;
   private
      Is_Open : Boolean := True;
      Count   : Unsigned_32 := 0;
   end Always;

   Stop_Clock : constant Timers.Word := 2;

   At_Handler : Timers.Word := 0 with Volatile;
   --  Timer at the first statement of its interrupt's handler

   Handled : Boolean := False with Volatile;
   --  Since the timer was started

   protected Source with Interrupt_Priority => Level is
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

   protected body Always is

      entry Pass when Is_Open is
      begin
         Count := Count + 1;
      end Pass;

   end Always;

   protected body Source is
      procedure Handle is
      begin
         At_Handler := Channel_1.Value;
         Acknowledge (Channel_1);
         Set_True (Served);
      end Handle;
   end Source;

   procedure Touch_Plain with No_Inline;

   procedure Touch_Plain is
   begin
      Plain := Plain + 1;
   end Touch_Plain;

   procedure Measure_Calls is
      Start : Cycles;
   begin
      for Sample in 1 .. Samples loop
         Spend (Random (50));
         Start := Stopwatch;
         Note (Results (Two_Readings), Since (Start));
         Start := Stopwatch;
         Touch_Plain;
         Note (Results (Plain_Call), Since (Start));
         Start := Stopwatch;
         Object.Touch;
         Note (Results (Protected_Call), Since (Start));
         Start := Stopwatch;
         Always.Pass;
         Note (Results (Open_Entry_Call), Since (Start));
      end loop;
   end Measure_Calls;

   procedure Measure_Releases is
   begin
      for Sample in 1 .. Samples loop
         Spend (Random (50));
         Started_At := Stopwatch;
         Set_True (Released);
         Note (Results (Voluntary_Switch), Since (Suspended_At));
         Spend (Random (50));
         Started_At := Stopwatch;
         Gate.Open;
      end loop;
   end Measure_Releases;

   --  The timer starts again at its request, so that its value is the time since then

   procedure Measure_Interrupts is
   begin
      for Sample in 1 .. Samples loop
         Handled := False;
         Start_Cyclic (Channel_1, 500 + Timers.Word (Random (500)));
         while not Handled loop
            Spend (1);
         end loop;
      end loop;
   end Measure_Interrupts;

   task body Low is
   begin
      delay until Time_Of (0, Milliseconds (2));
      Start_Stopwatch (Channel_2);
      Measure_Calls;
      Measure_Releases;
      Measure_Interrupts;
      Finished := True;
   end Low;

   task body High is
   begin
      loop
         Suspended_At := Stopwatch;
         Suspend_Until_True (Released);
         Note (Results (Task_Released), Since (Started_At));
      end loop;
   end High;

   task body Waiting is
   begin
      loop
         Gate.Pass;
         Note (Results (Entry_Opened), Since (Started_At));
      end loop;
   end Waiting;

   task body Server is
      Passed : Cycles;
   begin
      loop
         Suspend_Until_True (Served);
         Passed := 2 * Cycles (Channel_1.Value);
         Channel_1.Control := Stop_Clock;
         Note (Results (Interrupt_To_Handler), 2 * Cycles (At_Handler));
         Note (Results (Interrupt_To_Task), Passed);
         Handled := True;
      end loop;
   end Server;

end Measured_Services;
