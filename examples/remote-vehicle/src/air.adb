--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;      use Ada.Real_Time;
with Joystick_Commands;  use Joystick_Commands;
with NXT.AVR;
with NXT.Bluetooth;      use NXT.Bluetooth;
with NXT.Bytes;
with NXT.Frames;

package body Air is

   First_Release : constant Time := NXT.AVR.First_Release;

   Period : constant Time_Span := Milliseconds (10);
   Chunk  : constant := 32;

   protected Last with Priority => System.Priority'First + 2 is
      procedure Set (Item : Command; Now : Time);
      procedure Set_Connected (Now : Boolean);
      procedure Get (Item : out Command; State : out Contact);
   private
      Current     : Command;
      Valid_Until : Time := Time_First;
      Connected   : Boolean := False;
   end Last;

   protected body Last is

      procedure Set (Item : Command; Now : Time) is
      begin
         Current := Item;
         Valid_Until := Now + Milliseconds (Longest_Silence_Ms);
      end Set;

      procedure Set_Connected (Now : Boolean) is
      begin
         Connected := Now;
      end Set_Connected;

      procedure Get (Item : out Command; State : out Contact) is
      begin
         Item := (others => <>);
         if Clock <= Valid_Until then
            Item := Current;
            State := Heard;
         else
            State := (if Connected then Silent else Nobody);
         end if;
      end Get;

   end Last;

   procedure Get (Command : out Joystick_Commands.Command; State : out Contact) is
   begin
      Last.Get (Command, State);
   end Get;

   Line : NXT.Frames.Reader;

   procedure Hear is
      Data     : NXT.Bytes.Byte_Array (1 .. Chunk);
      Length   : Natural;
      Complete : Boolean;
      Latest   : Command;
      Is_Heard : Boolean := False;
   begin
      Receive (Data, Length);
      for Item of Data (1 .. Length) loop
         pragma Annotate (Ravenbrick, Iterations, 32, "Chunk");
         NXT.Frames.Feed (Line, Item, Complete);
         if Complete and then Is_Command (Line) then
            Latest := To_Command (Line);
            Is_Heard := True;
         end if;
      end loop;
      if Is_Heard then
         Last.Set (Latest, Clock);
      end if;
   end Hear;

   --  Its waits are none of the task's own.
   procedure Start with No_Inline;

   procedure Start is
      Name : Friendly_Name;
   begin
      loop
         pragma Annotate (Ravenbrick, Iterations, 600, "ten minutes, before the first job");
         Initialize;
         exit when Available;
         delay until Clock + Seconds (1);
      end loop;
      Convert_To_Friendly_Name (Vehicle_Name, Name);
      Set_Friendly_Name (Name);
      Set_Discoverable (True);
      Serve (To_Pin (Vehicle_Pin));
   end Start;

   task body Radio_Task is
      Next_Release : Time;
   begin
      Start;
      Next_Release := First_Release + Period * ((Clock - First_Release) / Period + 1);
      loop
         Next_Release := Next_Release + Period;
         delay until Next_Release;
         Poll;
         Last.Set_Connected (State = Connected);
         Hear;
      end loop;
   end Radio_Task;

end Air;
