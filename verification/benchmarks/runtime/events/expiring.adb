--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time.Timing_Events; use Ada.Real_Time, Ada.Real_Time.Timing_Events;
with System;

with Interfaces; use Interfaces;

package body Expiring is

   Event : Timing_Event;

   protected Alarm with Interrupt_Priority => System.Interrupt_Priority'First is
      procedure Start;
      procedure Handle (Event : in out Timing_Event);
   private
      Next : Time := Time_First;
   end Alarm;

   protected body Alarm is

      procedure Start is
      begin
         Next := Clock + Milliseconds (2);
         Set_Handler (Event, Next, Handle'Access);
      end Start;

      procedure Handle (Event : in out Timing_Event) is
         Passed : constant Time_Span := Clock - Next;
      begin
         --  16 cycles are 7 units
         Note (Results, Cycles (16 * (Passed / Time_Span_Unit) / 7));
         if Results.Count < Samples then
            Next := Next + Microseconds (500) + Time_Span_Unit * Integer (Random (4_000));
            Set_Handler (Event, Next, Handle'Access);
         else
            Finished := True;
         end if;
      end Handle;

   end Alarm;

   procedure Be_Busy is
   begin
      Alarm.Start;
      loop
         Spend (100);
      end loop;
   end Be_Busy;

end Expiring;
