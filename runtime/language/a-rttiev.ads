--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Timing events (Ada RM D.15). Handlers are called by the alarm's interrupt, which has the lowest
--  level; inside they have the ceiling of their protected object. Events are at library level
--  (No_Local_Timing_Events).

private with Ravenbrick.Threads;

package Ada.Real_Time.Timing_Events is

   type Timing_Event is tagged limited private;

   type Timing_Event_Handler is access protected procedure (Event : in out Timing_Event);

   procedure Set_Handler
     (Event : in out Timing_Event; At_Time : Time; Handler : Timing_Event_Handler);
   --  Call Handler at At_Time, at once when it has passed, instead of what Event was set to;
   --  null clears Event

   procedure Set_Handler
     (Event : in out Timing_Event; In_Time : Time_Span; Handler : Timing_Event_Handler);
   --  The same with a time from now

   function Current_Handler (Event : Timing_Event) return Timing_Event_Handler;
   --  Null when Event is not set

   procedure Cancel_Handler (Event : in out Timing_Event; Cancelled : out Boolean);
   --  Clear Event; whether it was set

   function Time_Of_Event (Event : Timing_Event) return Time;
   --  Time_First when Event is not set

private

   type Timing_Event is tagged limited record
      Handler : Timing_Event_Handler;
      Alarm   : aliased Ravenbrick.Threads.Thread;
   end record;

end Ada.Real_Time.Timing_Events;
