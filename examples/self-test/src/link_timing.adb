--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;  use Ada.Real_Time;
with NXT.AVR;        use NXT.AVR;
with NXT.TWI;
with Results;

package body Link_Timing is

   use type NXT.TWI.Transfer_Status;

   Quiet_After : constant Time_Span := Microseconds (1_200);
   Transfers   : constant := 200;

   --  When the link's task is released next
   function Next_Release return Time is
     (First_Release + Period * ((Clock - First_Release) / Period + 1));

   procedure Await_Quiet is
   begin
      delay until Next_Release + Quiet_After;
   end Await_Quiet;

   type Statistics is record
      Sum      : Time_Span := Time_Span_Zero;
      Shortest : Time_Span := Time_Span_Last;
      Count    : Natural := 0;
   end record;

   procedure Add (To : in out Statistics; Span : Time_Span) is
   begin
      To.Sum := To.Sum + Span;
      To.Count := To.Count + 1;
      if Span < To.Shortest then
         To.Shortest := Span;
      end if;
   end Add;

   procedure Put (Name : String; Item : Statistics) is
      Microseconds_Of_All : constant Integer := Item.Sum * 1_000 / Milliseconds (1);
   begin
      Results.Put_Thousandths (Name, Microseconds_Of_All * 1_000 / Item.Count, "us");
   end Put;

   procedure Measure is
      Errors_Before : constant Error_Count := Link_Errors;
      Receiving     : Statistics;
      Sending       : Statistics;
      Pauses        : Statistics;
      Release       : Time := Next_Release;
      Ended         : Time;
      Is_Receiving  : Boolean := ((Release - First_Release) / Period) mod 2 = 0;
   begin
      for Number in 1 .. Transfers loop
         delay until Release;
         while NXT.TWI.Status = NXT.TWI.Busy loop
            null;
         end loop;
         Ended := Clock;
         if Is_Receiving then
            Add (Receiving, Ended - Release);
         else
            Add (Sending, Ended - Release);
         end if;
         Release := Release + Period;
         Add (Pauses, Release - Ended);
         Is_Receiving := not Is_Receiving;
      end loop;
      Put ("link.receive", Receiving);
      Put ("link.send", Sending);
      Results.Put ("link.pause_shortest", Pauses.Shortest * 1_000 / Milliseconds (1), "us");
      Results.Put ("link.errors", Integer (Link_Errors - Errors_Before), "transfers");
      Results.Put ("link.errors_before", Integer (Errors_Before), "transfers");
      Results.Put ("link.losses", Integer (Link_Losses), "losses");
   end Measure;

end Link_Timing;
