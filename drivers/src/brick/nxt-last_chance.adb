--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;
with Interfaces;
with NXT.AVR_IO;
with NXT.Configuration;
with NXT.Fonts;
with NXT.Forced_Power_Off;
with NXT.LCD;
with NXT.SPI.Bus;
with NXT.TWI.Bus;
with NXT.Watchdog;
with Ravenbrick.Clock;
with Ravenbrick.Failures.Context;

package body NXT.Last_Chance is

   pragma Suppress (All_Checks);
   --  A second failure would end here again.

   use Interfaces;
   use NXT.LCD;

   Longest_Text : constant := 64;
   subtype Text_Length is Natural range 0 .. Longest_Text;

   type Text is record
      Length  : Text_Length := 0;
      Letters : String (1 .. Longest_Text) := (others => ' ');
   end record;

   procedure Append (To : in out Text; Letter : Character) is
   begin
      if To.Length < Longest_Text then
         To.Length := To.Length + 1;
         To.Letters (To.Length) := Letter;
      end if;
   end Append;

   procedure Append_Message (To : in out Text; Source : System.Address) is
      Letters : String (1 .. Longest_Text) with Import, Address => Source;
   begin
      for Letter of Letters loop
         exit when Letter = ASCII.NUL;
         Append (To, Letter);
      end loop;
   end Append_Message;

   procedure Append_Number (To : in out Text; Number : Natural) is
   begin
      if Number >= 10 then
         Append_Number (To, Number / 10);
      end if;
      Append (To, Character'Val (Character'Pos ('0') + Number mod 10));
   end Append_Number;

   procedure Append_Address (To : in out Text; Address : Unsigned_32) is
      Hex_Digits : constant String (1 .. 16) := "0123456789ABCDEF";
   begin
      for Place in reverse 0 .. 7 loop
         Append (To, Hex_Digits (1 + Natural (Shift_Right (Address, 4 * Place) and 16#F#)));
      end loop;
   end Append_Address;

   procedure Append_Place (To : in out Text; Line : Integer) is
      Longest_Source : constant := 99_999;
   begin
      if Line /= 0 then
         Append (To, ':');
      end if;
      if Line in 1 .. Longest_Source then
         Append_Number (To, Line);
      elsif Line /= 0 then
         Append_Address (To, Unsigned_32'Mod (Line));
      end if;
   end Append_Place;

   procedure Stop_Motors is
      Attempts     : constant := 3;
      Acknowledged : Boolean;
   begin
      for Attempt in 1 .. Attempts loop
         TWI.Bus.Reset;
         TWI.Bus.Send_Polled
           (AVR_IO.Address, AVR_IO.Encode (AVR_IO.All_Stopped), Acknowledged);
         exit when Acknowledged;
      end loop;
   end Stop_Motors;

   procedure Draw_Row (Row : Pixel_Rows; Letters : String) is
      Pixels : SPI.Byte_Array (Pixel_Columns) := (others => 0);
      Left   : Natural;
   begin
      for Place in Letters'Range loop
         Left := Fonts.Left_Edge (Place - Letters'First);
         for Part in Fonts.Glyph_Columns loop
            Pixels (Left + Part) := Fonts.Shape_Of (Letters (Place)) (Part);
         end loop;
      end loop;
      SPI.Bus.Send_Polled (SPI.Command, (16#B0# + SPI.Byte (Row), 16#10#, 16#00#));
      SPI.Bus.Send_Polled (SPI.Pixels, Pixels);
   end Draw_Row;

   --  The title in the first row, the text from the third on, behind it who failed, blanks
   --  elsewhere.
   procedure Report (Message : Text) is
      package Context renames Ravenbrick.Failures.Context;
      Width     : constant := Fonts.Text_Columns;
      First_Row : constant := 2;
      Own_Rows  : constant Natural := (Message.Length + Width - 1) / Width;
      Start     : Positive;
      Who       : Context.Line;
   begin
      SPI.Bus.Configure;
      SPI.Bus.Send_Polled (SPI.Command, LCD.Set_Up);
      Draw_Row (0, "Program failed");
      Draw_Row (1, "");
      for Row in First_Row .. Pixel_Rows'Last loop
         if Row < First_Row + Own_Rows then
            Start := 1 + Width * (Row - First_Row);
            Draw_Row
              (Row, Message.Letters (Start .. Natural'Min (Start + Width - 1, Message.Length)));
         elsif Row - First_Row - Own_Rows < Natural (Context.Line_Number'Last) then
            Who := Context.Describe (Context.Line_Number (Row - First_Row - Own_Rows + 1));
            Draw_Row (Row, Who.Text (1 .. Natural'Min (Width, Who.Length)));
         else
            Draw_Row (Row, "");
         end if;
      end loop;
   end Report;

   procedure Stop_And_Report (Source : System.Address; Line : Integer) is
      Message : Text;
   begin
      Stop_Motors;
      Append_Message (Message, Source);
      Append_Place (Message, Line);
      Report (Message);
   end Stop_And_Report;

   --  As long as a frame of the link lasts in NXT.AVR, less the time of the transfer before. No
   --  interrupt of the run-time notes the count of the clock any more, so that its wraps are seen.
   procedure Await_Next (Transfer : in out Ada.Real_Time.Time) is
      use Ada.Real_Time;
      Now   : Ravenbrick.Clock.Units;
      Count : Ravenbrick.Clock.Count;
   begin
      Ravenbrick.Clock.Observe (Now, Count);
      Watchdog.Restart;
      Transfer := Transfer + Milliseconds (Configuration.Link_Period_Ms);
      while Clock < Transfer loop
         null;
      end loop;
   end Await_Next;

   procedure Receive_Button (Pressed : out Button_Id; Judgement : out AVR_IO.Verdict) is
      Frame    : AVR_IO.Input_Frame;
      Values   : AVR_IO.Inputs;
      Complete : Boolean;
   begin
      TWI.Bus.Receive_Polled (AVR_IO.Address, Frame, Complete);
      AVR_IO.Decode (Frame, Values, Judgement);
      Pressed := Values.Pressed;
      if not Complete then
         Judgement := AVR_IO.Corrupt;
      end if;
   end Receive_Button;

   --  The co-processor gets a frame in each round: one that hears nothing makes the loudspeaker
   --  click, and goes on with what it was told last.
   procedure Await_Power_Button is
      use type AVR_IO.Verdict;
      Command      : AVR_IO.Outputs := AVR_IO.All_Stopped;
      Watch        : Forced_Power_Off.Button_Watch := Forced_Power_Off.Ready;
      Transfer     : Ada.Real_Time.Time := Ada.Real_Time.Clock;
      Acknowledged : Boolean;
      Pressed      : Button_Id;
      Judgement    : AVR_IO.Verdict;
      Held_Long    : Boolean;
   begin
      loop
         Await_Next (Transfer);
         TWI.Bus.Send_Polled (AVR_IO.Address, AVR_IO.Encode (Command), Acknowledged);
         Await_Next (Transfer);
         Receive_Button (Pressed, Judgement);
         if Judgement = AVR_IO.Valid then
            Forced_Power_Off.Observe (Watch, Pressed, Held_Long);
            if Held_Long then
               Command.Power := AVR_IO.Switch_Off;
            end if;
         end if;
         if not Acknowledged or else Judgement = AVR_IO.Corrupt then
            TWI.Bus.Reset;
         end if;
      end loop;
   end Await_Power_Button;

end NXT.Last_Chance;
