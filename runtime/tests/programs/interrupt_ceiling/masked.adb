--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts.Names; use Ada.Interrupts.Names;
with Ada.Real_Time; use Ada.Real_Time;

with Journal; use Journal;
with Timers; use Timers;

package body Masked is

   protected Low with Interrupt_Priority => Low_Level is
      procedure Handle with Attach_Handler => TC1;
      procedure Hold;
   end Low;

   protected High with Interrupt_Priority => High_Level is
      procedure Handle with Attach_Handler => TC2;
      procedure Hold;
   end High;

   procedure Wait is
      Start : constant Time := Clock;
   begin
      while Clock - Start < Microseconds (300) loop
         null;
      end loop;
   end Wait;

   protected body Low is
      procedure Handle is
      begin
         Acknowledge (Timers.Channel_1);
         Note ('l');
      end Handle;

      procedure Hold is
      begin
         Note ('(');
         Start_Once (Timers.Channel_1, 2_403);
         Start_Once (Timers.Channel_2, 2_403);
         Wait;
         Note (')');
      end Hold;
   end Low;

   protected body High is
      procedure Handle is
      begin
         Acknowledge (Timers.Channel_2);
         Note ('h');
      end Handle;

      procedure Hold is
      begin
         Note ('[');
         Start_Once (Timers.Channel_1, 2_403);
         Start_Once (Timers.Channel_2, 2_403);
         Wait;
         Note (']');
      end Hold;
   end High;

   task body User is
      Next : Time := Clock;
   begin
      loop
         Next := Next + Milliseconds (2);
         delay until Next;
         Low.Hold;
         Note (',');
         High.Hold;
         Note (';');
      end loop;
   end User;

end Masked;
