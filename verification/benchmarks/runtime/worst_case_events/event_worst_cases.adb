--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts.Names; use Ada.Interrupts.Names;
with Ada.Real_Time.Timing_Events; use Ada.Real_Time, Ada.Real_Time.Timing_Events;
with Ada.Synchronous_Task_Control; use Ada.Synchronous_Task_Control;

with Alarm_Phases; use Alarm_Phases;
with Handshake;
with Series; use Series;
with Timers; use Timers;

package body Event_Worst_Cases is

   type Event_Number is range 1 .. 4;

   Events : array (Event_Number) of Timing_Event;
   Cues   : array (Listener_Number) of Suspension_Object;

   protected Bell with Interrupt_Priority => System.Interrupt_Priority'Last is
      procedure Ring (Event : in out Timing_Event);
   private
      Count : Natural := 0;
   end Bell;

   protected Source with Interrupt_Priority => System.Interrupt_Priority'First + 4 is
      procedure Cue_All with Attach_Handler => TC1;
   end Source;

   procedure Move_Last (To : Time) with No_Inline;
   procedure Cancel_Last with No_Inline;

   protected body Bell is
      procedure Ring (Event : in out Timing_Event) is
         pragma Unreferenced (Event);
      begin
         Count := Count + 1;
      end Ring;
   end Bell;

   protected body Source is
      procedure Cue_All is
      begin
         Acknowledge (Channel_1);
         for Cue of Cues loop
            Set_True (Cue);
         end loop;
      end Cue_All;
   end Source;

   task body Listener is
   begin
      loop
         Suspend_Until_True (Cues (Number));
      end loop;
   end Listener;

   procedure Move_Last (To : Time) is
   begin
      Set_Handler (Events (Event_Number'Last), To, Bell.Ring'Access);
   end Move_Last;

   procedure Cancel_Last is
      Was_Set : Boolean;
   begin
      Cancel_Handler (Events (Event_Number'Last), Was_Set);
   end Cancel_Last;

   --  The listeners become ready while the environment task is in a protected action, which ends at
   --  each phase of an event's expiry; another event comes soon after

   procedure Set_First_And_Last (Expiry : Time) is
   begin
      Set_Handler (Events (Event_Number'First), Expiry, Bell.Ring'Access);
      Set_Handler (Events (Event_Number'Last), Expiry + Milliseconds (1), Bell.Ring'Access);
      Start_Once (Channel_1, Soon);
   end Set_First_And_Last;

   procedure Play_Phases is new Play_Each (Prepare => Set_First_And_Last);

   procedure Set_All (From : Time) is
   begin
      for Number in Event_Number loop
         Set_Handler
           (Events (Number), From + Microseconds (100) * Integer (Number), Bell.Ring'Access);
      end loop;
   end Set_All;

   procedure Play is
      First_Wrap  : constant Time := Time_Of (0, Whole_Count);
      Second_Wrap : constant Time := Time_Of (0, Whole_Count * 2);
   begin
      Handshake.Send;
      delay until First_Wrap - Milliseconds (30);
      Play_Phases;
      delay until First_Wrap - Milliseconds (1);
      Set_All (From => First_Wrap + Milliseconds (1));
      Spend (2_000);
      Move_Last (First_Wrap + Microseconds (1_600));
      Cancel_Last;
      Move_Last (First_Wrap + Microseconds (1_700));
      delay until Second_Wrap - Milliseconds (1);
      Set_All (From => Second_Wrap + Milliseconds (2));
      Spend (2_000);
      Move_Last (Second_Wrap + Microseconds (1_900));
      delay until Second_Wrap + Milliseconds (3);
      Finished := True;
   end Play;

end Event_Worst_Cases;
