--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;           use Ada.Real_Time;
with NXT.Bytes;               use NXT.Bytes;
with NXT.Frames;
with NXT.Telemetry.Messages;  use NXT.Telemetry.Messages;

package body NXT.Telemetry.Server is

   Silence_Limit : constant Time_Span := Seconds (3);
   Status_Period : constant Time_Span := Seconds (1);
   Chunk         : constant := 32;
   Most_Chunks   : constant := 2;
   Longest_Line  : constant := Longest_Message + Frames.Overhead;

   task Talker with Priority => Priority, Storage_Size => Stack_Bytes;

   type Description is range 0 .. 1 + Signal_Number'Last + Maximum_Parameter;
   --  Of the program: hello, signals, parameters, in this order

   Most_Changes : constant := 4;
   type Change is record
      Index  : Byte := 0;
      Wanted : Four_Bytes := (others => 0);
   end record;
   type Change_Queue is array (1 .. Most_Changes) of Change;

   type State is record
      Listening   : Boolean := False;
      Refuse      : Boolean := False;
      Described   : Description := Description'Last;
      Changes     : Change_Queue;
      Unanswered  : Natural range 0 .. Most_Changes := 0;
      Last_Word   : Time := Time_First;
      Next_Status : Time := Time_First;
      Sent        : Unsigned_32 := 0;
      Host        : Frames.Reader;
   end record;
   --  Described: descriptions sent since the host asked.

   Now_Is : State;
   Out_Going : Builder;
   Line      : Byte_Array (1 .. Longest_Line);

   function All_Described return Description is
     (1 + Description (Last_Signal) + Description (Parameter_Count));

   procedure Send_Frame (Content : Builder) is
      Last : Natural;
   begin
      Frames.Encode (Content.Data (1 .. Content.Last), Line, Last);
      Send (Line (1 .. Last));
   end Send_Frame;

   --  One too many is forgotten; the host repeats what is not answered.
   procedure Note_Change is
   begin
      if Now_Is.Unanswered < Most_Changes then
         Now_Is.Unanswered := Now_Is.Unanswered + 1;
         declare
            Item : Change renames Now_Is.Changes (Now_Is.Unanswered);
         begin
            Read_Set (Now_Is.Host, Item.Index, Item.Wanted);
         end;
      end if;
   end Note_Change;

   procedure Answer_Change is
      Item : Change renames Now_Is.Changes (Now_Is.Unanswered);
   begin
      Build_Answer (Out_Going, Item.Index, Item.Wanted);
      Now_Is.Unanswered := Now_Is.Unanswered - 1;
   end Answer_Change;

   procedure Obey (Now : Time) is
   begin
      Now_Is.Last_Word := Now;
      case Wish_In (Now_Is.Host) is
         when Nothing | Keep_Alive =>
            null;
         when Ask =>
            Now_Is.Listening := True;
            Now_Is.Described := 0;
            Now_Is.Next_Status := Now;
            Listen (True);
         when Ask_Other_Version =>
            Now_Is.Refuse := True;
         when Set_Parameter =>
            Note_Change;
         when Stop =>
            Now_Is.Listening := False;
            Listen (False);
      end case;
   end Obey;

   procedure Hear (Now : Time) is
      Data     : Byte_Array (1 .. Chunk);
      Last     : Natural;
      Complete : Boolean;
   begin
      for Round in 1 .. Most_Chunks loop
         Receive (Data, Last);
         for Item of Data (1 .. Last) loop
            pragma Annotate (Ravenbrick, Iterations, 32, "Chunk");
            Frames.Feed (Now_Is.Host, Item, Complete);
            if Complete then
               Obey (Now);
            end if;
         end loop;
         exit when Last < Data'Last;
      end loop;
   end Hear;

   procedure Describe_Next (Now : Time) is
      Signals_End : constant Description := 1 + Description (Last_Signal);
   begin
      if Now_Is.Described = 0 then
         Build_Hello (Out_Going, Program_Name, Now);
      elsif Now_Is.Described < Signals_End then
         Build_Signal (Out_Going, Signal_Number (Now_Is.Described));
      else
         Build_Parameter (Out_Going, Parameter (Now_Is.Described - Signals_End + 1));
      end if;
      Now_Is.Described := Now_Is.Described + 1;
   end Describe_Next;

   --  What is most urgent, if anything.
   procedure Build_Next (Now : Time; Found : out Boolean) is
      Slot : Sample_Slot;
   begin
      Found := True;
      if Now_Is.Refuse then
         Now_Is.Refuse := False;
         Build_Refused (Out_Going);
      elsif Now_Is.Unanswered > 0 then
         Answer_Change;
      elsif not Now_Is.Listening then
         Found := False;
      elsif Now_Is.Described < All_Described then
         Describe_Next (Now);
      elsif Now >= Now_Is.Next_Status then
         Now_Is.Next_Status := Now + Status_Period;
         Build_Status (Out_Going, Now_Is.Sent, Frames.Damaged (Now_Is.Host));
      else
         Take (Slot, Found);
         if Found then
            Now_Is.Sent := Now_Is.Sent + 1;
            Build_Sample (Out_Going, Slot);
         end if;
      end if;
   end Build_Next;

   procedure Speak (Now : Time) is
      Found : Boolean;
   begin
      for Count in 1 .. Most_Frames loop
         exit when Room < Longest_Line;
         Build_Next (Now, Found);
         exit when not Found;
         Send_Frame (Out_Going);
      end loop;
   end Speak;

   procedure Require is null;

   task body Talker is
      Period : constant Time_Span := Milliseconds (Period_Ms);
      Next   : Time;
      Now    : Time;
   begin
      Start;
      Next := Clock;
      loop
         Now := Clock;
         Attend;
         Hear (Now);
         if Now_Is.Listening and then Now - Now_Is.Last_Word > Silence_Limit then
            Now_Is.Listening := False;
            Listen (False);
         end if;
         Speak (Now);
         Next := Next + Period;
         delay until Next;
      end loop;
   end Talker;

end NXT.Telemetry.Server;
