--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;           use Ada.Real_Time;
with NXT.Bytes;               use NXT.Bytes;
with NXT.Frames;
with NXT.Telemetry.Messages;  use NXT.Telemetry.Messages;

package body NXT.Telemetry.Server is

   Silence_Limit  : constant Time_Span := Seconds (3);
   Status_Period  : constant Time_Span := Seconds (1);
   Chunk          : constant := 64;
   --  What a job takes at most.
   Longest_Line   : constant := Longest_Message + Frames.Overhead;

   task Server_Task with Priority => Priority, Storage_Size => Stack_Bytes;

   type Description is range 0 .. 1 + Signal_Number'Last + Maximum_Parameter;
   --  Of the program: hello, signals, parameters, in this order

   Change_Limit : constant := 4;
   type Change is record
      Index     : Byte := 0;
      New_Value : Four_Bytes := (others => 0);
   end record;
   type Change_Queue is array (1 .. Change_Limit) of Change;

   type State is record
      Listening   : Boolean := False;
      Switched    : Boolean := False;
      Refuse      : Boolean := False;
      Described   : Description := Description'Last;
      Changes     : Change_Queue;
      Unconfirmed : Natural range 0 .. Change_Limit := 0;
      Last_Heard  : Time := Time_First;
      Next_Status : Time := Time_First;
      Sent        : Unsigned_32 := 0;
      Host        : Frames.Reader;
   end record;
   --  Switched: the host asked for samples, anew or no longer, in this job. Described: descriptions
   --  sent since it asked.

   Server_State : State;
   Outgoing     : Builder;
   Line         : Byte_Array (1 .. Longest_Line);

   function All_Described return Description is
     (1 + Description (Last_Signal) + Description (Parameter_Count));

   procedure Send_Frame (Content : Builder) is
      Last : Natural;
   begin
      Frames.Encode (Content.Data (1 .. Content.Last), Line, Last);
      Send (Line (1 .. Last));
   end Send_Frame;

   --  One too many is forgotten; the host repeats what is not answered.
   procedure Queue_Change is
   begin
      if Server_State.Unconfirmed < Change_Limit then
         Server_State.Unconfirmed := Server_State.Unconfirmed + 1;
         declare
            Item : Change renames Server_State.Changes (Server_State.Unconfirmed);
         begin
            Read_Set (Server_State.Host, Item.Index, Item.New_Value);
         end;
      end if;
   end Queue_Change;

   procedure Confirm_Change is
      Item : Change renames Server_State.Changes (Server_State.Unconfirmed);
   begin
      Build_Answer (Outgoing, Item.Index, Item.New_Value);
      Server_State.Unconfirmed := Server_State.Unconfirmed - 1;
   end Confirm_Change;

   procedure Apply_Request (Now : Time) is
   begin
      Server_State.Last_Heard := Now;
      case Request_In (Server_State.Host) is
         when Nothing | Keep_Alive =>
            null;
         when Ask =>
            Server_State.Listening := True;
            Server_State.Described := 0;
            Server_State.Next_Status := Now;
            Server_State.Switched := True;
         when Ask_Other_Version =>
            Server_State.Refuse := True;
         when Set_Parameter =>
            Queue_Change;
         when Stop =>
            Server_State.Listening := False;
            Server_State.Switched := True;
      end case;
   end Apply_Request;

   procedure Receive_Frames (Now : Time) is
      Data     : Byte_Array (1 .. Chunk);
      Last     : Natural;
      Complete : Boolean;
   begin
      Receive (Data, Last);
      for Item of Data (1 .. Last) loop
         pragma Annotate (Ravenbrick, Iterations, 64, "Chunk");
         Frames.Feed (Server_State.Host, Item, Complete);
         if Complete then
            Apply_Request (Now);
         end if;
      end loop;
   end Receive_Frames;

   procedure Describe_Next (Now : Time) is
      Signals_End : constant Description := 1 + Description (Last_Signal);
   begin
      if Server_State.Described = 0 then
         Build_Hello (Outgoing, Program_Name, Now);
      elsif Server_State.Described < Signals_End then
         Build_Signal (Outgoing, Signal_Number (Server_State.Described));
      else
         Build_Parameter (Outgoing, Parameter (Server_State.Described - Signals_End + 1));
      end if;
      Server_State.Described := Server_State.Described + 1;
   end Describe_Next;

   --  What is most urgent, if anything.
   procedure Build_Next (Now : Time; Found : out Boolean) is
      Slot : Sample_Slot;
   begin
      Found := True;
      if Server_State.Refuse then
         Server_State.Refuse := False;
         Build_Refused (Outgoing);
      elsif Server_State.Unconfirmed > 0 then
         Confirm_Change;
      elsif not Server_State.Listening then
         Found := False;
      elsif Server_State.Described < All_Described then
         Describe_Next (Now);
      elsif Now >= Server_State.Next_Status then
         Server_State.Next_Status := Now + Status_Period;
         Build_Status (Outgoing, Server_State.Sent, Frames.Damaged (Server_State.Host));
      else
         Take (Slot, Found);
         if Found then
            Server_State.Sent := Server_State.Sent + 1;
            Build_Sample (Outgoing, Slot);
         end if;
      end if;
   end Build_Next;

   procedure Send_Frames (Now : Time) is
      Found : Boolean;
   begin
      for Count in 1 .. Most_Frames loop
         exit when Room < Longest_Line;
         Build_Next (Now, Found);
         exit when not Found;
         Send_Frame (Outgoing);
      end loop;
   end Send_Frames;

   procedure Require is null;

   Period : constant Time_Span := Milliseconds (Period_Ms);

   --  The next instant that lies whole periods after First_Release, by additions alone: a division
   --  of 64 bits would take 400 bytes more, for which the paper's image has no room.
   function Next_Release return Time with No_Inline;

   function Next_Release return Time is
      Now   : constant Time := Clock;
      Steps : array (1 .. 25) of Time_Span;
      --  Each twice the one before it: nine hours of periods of 1 ms in all.
   begin
      Steps (1) := Period;
      for Index in 2 .. Steps'Last loop
         Steps (Index) := Steps (Index - 1) + Steps (Index - 1);
      end loop;
      return Next : Time := First_Release do
         for Step of reverse Steps loop
            if Next + Step <= Now then
               Next := Next + Step;
            end if;
         end loop;
         if Next <= Now then
            Next := Next + Period;
         end if;
      end return;
   end Next_Release;

   task body Server_Task is
      Next : Time;
      Now  : Time;
   begin
      Start;
      Next := Next_Release;
      loop
         Next := Next + Period;
         delay until Next;
         Now := Clock;
         Attend;
         Receive_Frames (Now);
         if Server_State.Listening and then Now - Server_State.Last_Heard > Silence_Limit then
            Server_State.Listening := False;
            Server_State.Switched := True;
         end if;
         if Server_State.Switched then
            Server_State.Switched := False;
            Listen (Server_State.Listening);
         end if;
         Send_Frames (Now);
      end loop;
   end Server_Task;

end NXT.Telemetry.Server;
