--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts.Names; use Ada.Interrupts.Names;
with Ada.Real_Time; use Ada.Real_Time;
with Ada.Synchronous_Task_Control; use Ada.Synchronous_Task_Control;

with Journal; use Journal;
with Timers; use Timers;

package body Handlers is

   Wake_Server : Suspension_Object;

   procedure Wait (Span : Time_Span) is
      Start : constant Time := Clock;
   begin
      while Clock - Start < Span loop
         null;
      end loop;
   end Wait;

   protected Low with Interrupt_Priority => Low_Level is
      procedure Handle with Attach_Handler => TC1;
   end Low;

   protected High with Interrupt_Priority => High_Level is
      procedure Handle with Attach_Handler => TC2;
      procedure Touch;
   end High;

   protected body Low is
      procedure Handle is
      begin
         Acknowledge (Timers.Channel_1);
         Note ('(');
         Wait (Microseconds (200));
         Note ('|');
         High.Touch;
         Note (')');
      end Handle;
   end Low;

   protected body High is

      procedure Handle is
      begin
         Acknowledge (Timers.Channel_2);
         Note ('[');
         Set_True (Wake_Server);
         Wait (Microseconds (100));
         Note (']');
      end Handle;

      procedure Touch is
      begin
         Note ('t');
      end Touch;

   end High;

   task body Server is
   begin
      loop
         Suspend_Until_True (Wake_Server);
         Note ('s');
      end loop;
   end Server;

   --  Counts of 2 cycles: 2_403 are 100 us. First the low level's timer rings 100 us before the
   --  high level's, whose handler thus comes in between; then 50 us after it.

   task body Starter is
      Next : Time := Clock;
   begin
      loop
         Next := Next + Milliseconds (2);
         delay until Next;
         Start_Once (Timers.Channel_1, 2_403);
         Start_Once (Timers.Channel_2, 4_806);
         Next := Next + Milliseconds (2);
         delay until Next;
         Note (';');
         Start_Once (Timers.Channel_2, 2_403);
         Start_Once (Timers.Channel_1, 3_605);
         Next := Next + Milliseconds (2);
         delay until Next;
         Note ('.');
      end loop;
   end Starter;

end Handlers;
