--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Two bricks on one RS485 line: the one whose touch sensor is pressed at the start asks, with
--  messages of growing length; the other one answers each with every byte inverted.

with Ada.Real_Time;      use Ada.Real_Time;
with Interfaces;         use Interfaces;
with NXT.AVR;
with NXT.RS485;          use NXT.RS485;
with NXT.Touch_Sensors;  use NXT.Touch_Sensors;

procedure RS485_Line is

   Asked : Integer := 0 with Volatile, Export, Convention => C, External_Name => "asked";
   Right : Integer := 0 with Volatile, Export, Convention => C, External_Name => "right";
   Answered : Integer := 0 with Volatile, Export, Convention => C, External_Name => "answered";
   Heard : Integer := 0 with Volatile, Export, Convention => C, External_Name => "heard";
   Lost : Integer := 0 with Volatile, Export, Convention => C, External_Name => "lost";

   Switch : Touch_Sensor (NXT.Sensor_1);
   Period : constant Time_Span := Milliseconds (5);
   Next   : Time;

   subtype Length_Of_Message is Positive range 1 .. 30;

   --  A message is its length and so many bytes less one.
   procedure Ask (Length : Length_Of_Message) is
      Question : Byte_Array (1 .. Length);
      Answer   : Byte_Array (1 .. Length);
      Count    : Natural;
      Accepted : Boolean;
   begin
      for Place in Question'Range loop
         Question (Place) := Byte (17 * Place mod 256);
      end loop;
      Question (1) := Byte (Length);
      Send (Question, Accepted);
      Asked := Asked + Boolean'Pos (Accepted);
      Next := Next + Period;
      delay until Next;
      Receive (Answer, Count);
      if Count = Length
        and then (for all Place in Question'Range => Answer (Place) = not Question (Place))
      then
         Right := Right + 1;
      end if;
   end Ask;

   procedure Answer is
      Data     : Byte_Array (1 .. Length_Of_Message'Last);
      Count    : Natural;
      Accepted : Boolean;
   begin
      Next := Next + Milliseconds (1);
      delay until Next;
      Receive (Data, Count);
      Heard := Heard + Count;
      if Count > 0 and then Natural (Data (1)) = Count then
         for Item of Data loop
            Item := not Item;
         end loop;
         Send (Data (1 .. Count), Accepted);
         Answered := Answered + Boolean'Pos (Accepted);
      end if;
   end Answer;

begin
   NXT.AVR.Await_Data_Available;
   Open;
   Next := Clock + Milliseconds (20);
   delay until Next;
   if Switch.Pressed then
      for Length in Length_Of_Message loop
         Ask (Length);
      end loop;
      delay until Time_Last;
   end if;
   loop
      Answer;
      Lost := Boolean'Pos (Lost_Bytes);
   end loop;
end RS485_Line;
