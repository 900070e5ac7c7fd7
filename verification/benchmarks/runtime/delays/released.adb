--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;
with Ada.Synchronous_Task_Control; use Ada.Synchronous_Task_Control;

with Interfaces; use Interfaces;

with Series; use Series;

package body Released is

   Busy_Phase : Suspension_Object;

   procedure Be_Busy is
   begin
      Suspend_Until_True (Busy_Phase);
      loop
         Spend (100);
      end loop;
   end Be_Busy;

   --  Grid is the unit or the tick of the clock; Next is on it

   procedure Delay_At_Random (Next : in out Time; Grid : Time_Span) is
      Span : Time_Span;
   begin
      for Sample in 1 .. Samples loop
         Span := Time_Span_Unit * (2_000 + Integer (Random (42_000)));
         Next := Next + (Span / Grid) * Grid;
         delay until Next;
      end loop;
   end Delay_At_Random;

   task body Delayed is
      Next : Time := Time_Of (0, Tick * 15_000);
   begin
      Delay_At_Random (Next, Grid => Tick);
      Next := Next + Seconds (Pause_Seconds);
      delay until Next;
      Delay_At_Random (Next, Grid => Time_Span_Unit);
      Next := Next + Seconds (Pause_Seconds);
      delay until Next;
      Set_True (Busy_Phase);
      Delay_At_Random (Next, Grid => Time_Span_Unit);
      Finished := True;
      delay until Time_Last;
   end Delayed;

end Released;
