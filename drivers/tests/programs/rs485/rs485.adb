--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Sends messages to itself and compares what comes back; then sends without reading.

with Ada.Real_Time;  use Ada.Real_Time;
with Interfaces;     use Interfaces;
with NXT.RS485;      use NXT.RS485;

procedure RS485 is

   Received : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "received";
   Different : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "different";
   Refused : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "refused";
   Sent : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "sent";
   Lost_Early : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "lost_early";
   Lost_Late : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "lost_late";
   Span_Us : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "span_us";
   --  Time that a message of 100 bytes takes.

   Next_Sent, Next_Expected : Unsigned_8 := 1;
   Accepted : Boolean;

   procedure Send (Length : Positive) is
      Message : Byte_Array (1 .. Length);
   begin
      for Value of Message loop
         Value := Next_Sent;
         Next_Sent := Next_Sent * 5 + 3;
      end loop;
      Send (Message, Accepted);
      Sent := Sent + Length;
      Send ((1 => 0), Accepted);
      Refused := Refused + Boolean'Pos (not Accepted);
      Await_Sent;
   end Send;

   procedure Take is
      Data  : Byte_Array (1 .. 50);
      Count : Natural;
   begin
      loop
         Receive (Data, Count);
         exit when Count = 0;
         for Value of Data (1 .. Count) loop
            Different := Different + Boolean'Pos (Value /= Next_Expected);
            Next_Expected := Next_Expected * 5 + 3;
         end loop;
         Received := Received + Count;
      end loop;
   end Take;

   Start : Time;
begin
   Open (To => Loop_Back);
   for Length in 1 .. 60 loop
      Send (2 * Length);
      Take;
   end loop;
   Start := Clock;
   Send (100);
   Span_Us := (Clock - Start) / Microseconds (1);
   Take;
   Lost_Early := Boolean'Pos (Lost_Bytes);
   for Message in 1 .. 4 loop
      Send (Longest_Message);
   end loop;
   Lost_Late := Boolean'Pos (Lost_Bytes);
   Close;
   Send ((1 => 0), Accepted);
   Refused := Refused + Boolean'Pos (not Accepted);
   delay until Time_Last;
end RS485;
