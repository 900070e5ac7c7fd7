--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;
with Ada.Synchronous_Task_Control; use Ada.Synchronous_Task_Control;

with Interfaces; use Interfaces;

with Series; use Series;

package body Released is

   Second_Phase : Suspension_Object;

   procedure Be_Busy is
   begin
      Suspend_Until_True (Second_Phase);
      loop
         Spend (100);
      end loop;
   end Be_Busy;

   procedure Delay_At_Random (Next : in out Time) is
   begin
      for Sample in 1 .. Samples loop
         Next := Next + Microseconds (100 + Integer (Random (2_000)))
           + Time_Span_Unit * Integer (Random (100));
         delay until Next;
      end loop;
   end Delay_At_Random;

   task body Delayed is
      Next : Time := Time_Of (0, Milliseconds (5));
   begin
      Delay_At_Random (Next);
      Next := Next + Seconds (Pause_Seconds);
      delay until Next;
      Set_True (Second_Phase);
      Delay_At_Random (Next);
      Finished := True;
      delay until Time_Last;
   end Delayed;

end Released;
