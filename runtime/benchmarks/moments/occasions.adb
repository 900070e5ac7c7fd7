--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts.Names; use Ada.Interrupts.Names;
with Ada.Real_Time.Timing_Events; use Ada.Real_Time, Ada.Real_Time.Timing_Events;
with Ada.Synchronous_Task_Control; use Ada.Synchronous_Task_Control;

with Handshake;
with Series; use Series;
with Timers; use Timers;

package body Occasions is

   type Event_Number is range 1 .. 4;

   Events : array (Event_Number) of Timing_Event;
   Cues   : array (Listener_Number) of Suspension_Object;

   Whole_Count : constant Time_Span := (Tick * 2 ** 30) * 4;
   --  Until the clock's count of ticks begins again

   Soon : constant Timers.Word := 100;
   --  In counts of two cycles: while the action that started the timer lasts

   Before_Alarm : constant Time_Span := Microseconds (7);
   Hold_Turns   : constant := 60;
   --  From a reading of the clock until the alarm, and more turns than fit between them

   Shifts : constant := 3;
   --  Of the alarm, by one tick: a turn takes 7 cycles and a tick 16, so that the end of the action
   --  meets the alarm at each second cycle

   Marked : Boolean := False with Volatile;

   protected Bell with Interrupt_Priority => System.Interrupt_Priority'Last is
      procedure Ring (Event : in out Timing_Event);
   private
      Count : Natural := 0;
   end Bell;

   protected Source with Interrupt_Priority => System.Interrupt_Priority'First + 4 is
      procedure Cue_All with Attach_Handler => TC1;
   end Source;

   protected Object with Priority => 20 is
      procedure Hold_Until (At_Time : Time; Turns : Natural);
      --  And some cycles for each turn
   end Object;

   procedure Mark (Turns : Natural) with No_Inline;
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

   protected body Object is
      procedure Hold_Until (At_Time : Time; Turns : Natural) is
      begin
         while Clock < At_Time loop
            null;
         end loop;
         Mark (Turns);
      end Hold_Until;
   end Object;

   task body Listener is
   begin
      loop
         Suspend_Until_True (Cues (Number));
      end loop;
   end Listener;

   procedure Mark (Turns : Natural) is
   begin
      for Turn in 1 .. Turns loop
         Marked := True;
      end loop;
   end Mark;

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

   procedure Play_Phases is
      Looked, Expiry : Time;
   begin
      for Shift in 1 .. Shifts loop
         for Turns in 1 .. Hold_Turns loop
            Looked := Clock + Microseconds (80) - Before_Alarm;
            Expiry := Looked + Before_Alarm + Shift * Tick;
            Set_Handler (Events (Event_Number'First), Expiry, Bell.Ring'Access);
            Set_Handler (Events (Event_Number'Last), Expiry + Milliseconds (1), Bell.Ring'Access);
            Start_Once (Channel_1, Soon);
            Object.Hold_Until (Looked, Turns);
            delay until Expiry + Microseconds (40);
         end loop;
      end loop;
   end Play_Phases;

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

end Occasions;
