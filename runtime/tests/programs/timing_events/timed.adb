--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;
with Ada.Real_Time.Timing_Events; use Ada.Real_Time.Timing_Events;
with System;

with Journal; use Journal;

package body Timed is

   Single    : Timing_Event;
   Other     : Timing_Event;
   Repeating : Timing_Event;

   protected Bell with Interrupt_Priority => System.Interrupt_Priority'Last is
      procedure Ring (Event : in out Timing_Event);
      procedure Ring_Other (Event : in out Timing_Event);
      procedure Repeat (Event : in out Timing_Event);
      entry Wait;
   private
      Has_Rung : Boolean := False;
      Next     : Time := Time_Of (0, Milliseconds (3));
   end Bell;

   protected body Bell is

      procedure Ring (Event : in out Timing_Event) is
      begin
         Note (if Current_Handler (Event) = null then 'r' else '?');
         Has_Rung := True;
      end Ring;

      procedure Ring_Other (Event : in out Timing_Event) is
         pragma Unreferenced (Event);
      begin
         Note ('o');
      end Ring_Other;

      procedure Repeat (Event : in out Timing_Event) is
      begin
         Latest := Integer'Max (Latest, (Clock - Next) / Time_Span_Unit);
         Repeated := Repeated + 1;
         Next := Next + Microseconds (400);
         Set_Handler (Event, Next, Bell.Repeat'Access);
      end Repeat;

      entry Wait when Has_Rung is
      begin
         Has_Rung := False;
      end Wait;

   end Bell;

   task body Server is
   begin
      loop
         Bell.Wait;
         Note ('s');
      end loop;
   end Server;

   task body User is
      Next      : Time := Time_Of (0, Milliseconds (4));
      Cancelled : Boolean;
   begin
      Set_Handler (Repeating, Time_Of (0, Milliseconds (3)), Bell.Repeat'Access);
      loop
         delay until Next;

         --  in the past: before the next statement
         Set_Handler (Single, Next, Bell.Ring'Access);
         delay until Clock + Microseconds (50);
         Note ('p');

         --  in the order of their times, not of their setting
         Set_Handler (Single, Milliseconds (2), Bell.Ring'Access);
         Set_Handler (Other, Milliseconds (1), Bell.Ring_Other'Access);
         Next := Next + Milliseconds (3);
         delay until Next;

         --  moved back, and cancelled
         Set_Handler (Single, Next + Milliseconds (1), Bell.Ring'Access);
         Set_Handler (Single, Next + Milliseconds (3), Bell.Ring'Access);
         Note (if Time_Of_Event (Single) = Next + Milliseconds (3) then '3' else '?');
         Next := Next + Milliseconds (2);
         delay until Next;
         Cancel_Handler (Single, Cancelled);
         Note (if Cancelled then 'c' else '?');
         Cancel_Handler (Single, Cancelled);
         Note (if Cancelled or Time_Of_Event (Single) /= Time_First then '?' else '.');

         --  cancelled as the next of all
         Set_Handler (Single, Microseconds (100), Bell.Ring'Access);
         Cancel_Handler (Single, Cancelled);
         Note (if Cancelled then 'n' else '?');
         Next := Next + Milliseconds (3);
      end loop;
   end User;

end Timed;
