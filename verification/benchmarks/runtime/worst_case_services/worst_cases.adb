--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts.Names; use Ada.Interrupts.Names;
with Ada.Real_Time; use Ada.Real_Time;
with Ada.Synchronous_Task_Control; use Ada.Synchronous_Task_Control;

with Interfaces; use Interfaces;

with Alarm_Phases; use Alarm_Phases;
with Handshake;
with Series; use Series;
with Timers; use Timers;

package body Worst_Cases is

   type Part is (Return_At_Once, Sleep, Pass_The_Gate, Wake_The_Director);

   Parts : array (Actor_Number) of Part := (others => Return_At_Once) with Volatile_Components;
   Wakes : array (Actor_Number) of Time := (others => Time_First) with Volatile_Components;
   Cues  : array (Actor_Number) of Suspension_Object;

   Directors_Cue : Suspension_Object;

   Between_Wakes : constant Time_Span := Microseconds (50);

   First_Phase : constant Timers.Word := 480;
   Phase_Step  : constant Timers.Word := 3;
   Phases      : constant := 200;
   --  About the end of the action, in ARM and in Thumb code

   First_Cued : Actor_Number := 1 with Volatile;
   Last_Cued  : Actor_Number := Actor_Number'Last with Volatile;

   protected Source with Interrupt_Priority => System.Interrupt_Priority'First + 4 is
      procedure Cue_Actors with Attach_Handler => TC1;
   end Source;

   protected Late_Source with Interrupt_Priority => System.Interrupt_Priority'First + 5 is
      procedure Cue_Last with Attach_Handler => TC2;
   end Late_Source;

   protected Object with Priority => 20 is
      procedure Touch;
      procedure Hold (Turns : Cycles);
      --  And some cycles for each turn
   private
      Count : Cycles := 0;
   end Object;

   protected Masking with Interrupt_Priority => System.Interrupt_Priority'Last is
      procedure Touch;
   private
      Count : Cycles := 0;
   end Masking;

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
   end Always;

   Marked : Boolean := False with Volatile;
   Read   : Time := Time_First with Volatile;

   procedure Dwell with No_Inline;
   --  Longer than the timer runs until its interrupt, in a time that depends on nothing

   procedure Touch_Object with No_Inline;
   procedure Touch_Masking with No_Inline;
   procedure Open_Gate with No_Inline;
   procedure Pass_Always with No_Inline;
   procedure Pass_Gate with No_Inline;
   procedure Read_Clock with No_Inline;
   --  Services that are bounded for one object

   procedure Dwell is
   begin
      for Turn in 1 .. 120 loop
         Marked := True;
      end loop;
   end Dwell;

   protected body Source is
      procedure Cue_Actors is
      begin
         Acknowledge (Channel_1);
         for Number in First_Cued .. Last_Cued loop
            Set_True (Cues (Number));
         end loop;
      end Cue_Actors;
   end Source;

   protected body Late_Source is
      procedure Cue_Last is
      begin
         Acknowledge (Channel_2);
         Set_True (Cues (Actor_Number'Last));
      end Cue_Last;
   end Late_Source;

   protected body Object is
      procedure Touch is
      begin
         Dwell;
         Count := Count + 1;
      end Touch;

      procedure Hold (Turns : Cycles) is
      begin
         Spend (Turns);
      end Hold;
   end Object;

   protected body Masking is
      procedure Touch is
      begin
         Dwell;
         Count := Count + 1;
      end Touch;
   end Masking;

   protected body Gate is

      procedure Open is
      begin
         Dwell;
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
         Dwell;
      end Pass;
   end Always;

   procedure Touch_Object is
   begin
      Object.Touch;
   end Touch_Object;

   procedure Touch_Masking is
   begin
      Masking.Touch;
   end Touch_Masking;

   procedure Open_Gate is
   begin
      Gate.Open;
   end Open_Gate;

   procedure Pass_Always is
   begin
      Always.Pass;
   end Pass_Always;

   procedure Pass_Gate is
   begin
      Gate.Pass;
   end Pass_Gate;

   procedure Read_Clock is
   begin
      Read := Clock;
   end Read_Clock;

   procedure Cue_From (First : Actor_Number; Last : Actor_Number := Actor_Number'Last) is
   begin
      First_Cued := First;
      Last_Cued := Last;
      Start_Once (Channel_1, Soon);
   end Cue_From;

   procedure Let_All (Play : Part) is
   begin
      Parts := (others => Play);
   end Let_All;

   task body Actor is
   begin
      loop
         Suspend_Until_True (Cues (Number));
         case Parts (Number) is
            when Return_At_Once =>
               null;
            when Sleep =>
               delay until Wakes (Number);
            when Pass_The_Gate =>
               Pass_Gate;
            when Wake_The_Director =>
               Set_True (Directors_Cue);
         end case;
      end loop;
   end Actor;

   --  All actors become ready while the director is in a protected action

   procedure Play_Protected_Actions is
   begin
      Let_All (Return_At_Once);
      Cue_From (1);
      Touch_Object;
      Cue_From (1);
      Pass_Always;
      Cue_From (1);
      Touch_Masking;
   end Play_Protected_Actions;

   --  The last actor becomes ready at each phase of an exit from a protected action, also where the
   --  director is about to give the processor to the others: then the interrupt's exit does it

   procedure Play_Phases is
   begin
      for Phase in Timers.Word range 0 .. Phases - 1 loop
         Cue_From (1, Last => 3);
         Start_Once (Channel_2, First_Phase + Phase_Step * Phase);
         Touch_Object;
      end loop;
   end Play_Phases;

   --  The same with the alarm in place of the last actor's source

   procedure Sleep_And_Cue (Wake : Time) is
   begin
      Parts (1) := Sleep;
      Wakes (1) := Wake;
      Set_True (Cues (1));
      Cue_From (2);
   end Sleep_And_Cue;

   procedure Sleep_At_Each_Phase is new Play_Each (Prepare => Sleep_And_Cue);

   procedure Play_Alarm_Phases is
   begin
      Sleep_At_Each_Phase;
      Parts (1) := Return_At_Once;
   end Play_Alarm_Phases;

   --  One waits on the entry that the director opens, the others become ready before

   procedure Play_Entry is
   begin
      Parts (1) := Pass_The_Gate;
      Set_True (Cues (1));
      Cue_From (2);
      Open_Gate;
      Parts (1) := Return_At_Once;
   end Play_Entry;

   --  The director is put behind all actors, of which the first is running

   procedure Play_Suspension is
   begin
      Parts (1) := Wake_The_Director;
      Cue_From (1);
      Suspend_Until_True (Directors_Cue);
      Parts (1) := Return_At_Once;
      Set_True (Cues (1));
      Set_True (Directors_Cue);
      Set_False (Directors_Cue);
      Set_True (Directors_Cue);
      Suspend_Until_True (Directors_Cue);
   end Play_Suspension;

   --  The first actor's wake-up time comes while the others are ready and the director is in a
   --  protected action

   procedure Play_Alarm (Later : Time_Span) is
   begin
      Parts (1) := Sleep;
      Wakes (1) := Clock + Microseconds (400);
      Set_True (Cues (1));
      if Later > Time_Span_Zero then
         Parts (2) := Sleep;
         Wakes (2) := Wakes (1) + Later;
         Set_True (Cues (2));
      end if;
      Cue_From (if Later > Time_Span_Zero then 3 else 2);
      Object.Hold (Turns => 2_000);
      delay until Wakes (1) + Later + Milliseconds (1);
      Let_All (Return_At_Once);
   end Play_Alarm;

   procedure Play_Sleep (Until_Time : Time) is
   begin
      Let_All (Sleep);
      for Number in reverse Actor_Number'(2) .. Actor_Number'Last loop
         Wakes (Number) := Until_Time + Integer (Number) * Between_Wakes;
         Set_True (Cues (Number));
      end loop;
   end Play_Sleep;

   --  The count begins again while nobody reads the clock; the first to do so is an actor that goes
   --  to sleep after the others, or before them, or not at all because its time has passed

   procedure Play_Wrap (Wrap : Positive; At_Time : Time) is
   begin
      delay until At_Time - Milliseconds (1);
      case Wrap is
         when 1 | 2 =>
            Play_Sleep (At_Time + Milliseconds (1));
            Wakes (1) := At_Time + Microseconds (if Wrap = 1 then 1_500 else 700);
            Spend (2_000);
            Set_True (Cues (1));
         when 3 =>
            Spend (2_000);
            Read_Clock;
         when others =>
            Let_All (Sleep);
            Wakes := (others => Time_First);
            Spend (2_000);
            Cue_From (1);
            Spend (20);
      end case;
   end Play_Wrap;

   procedure Play is
   begin
      Handshake.Send;
      for Wrap in 1 .. Wraps loop
         declare
            At_Time : constant Time := Time_Of (0, Whole_Count * Wrap);
         begin
            delay until At_Time - Milliseconds (60);
            Play_Protected_Actions;
            if Wrap = 1 then
               Play_Phases;
               Play_Alarm_Phases;
            end if;
            Play_Entry;
            Play_Suspension;
            Play_Alarm (Time_Span_Zero);
            Play_Alarm (Milliseconds (1));
            Play_Alarm (Milliseconds (4));
            Play_Wrap (Wrap, At_Time);
            delay until At_Time + Milliseconds (3);
         end;
      end loop;
      Finished := True;
   end Play;

end Worst_Cases;
