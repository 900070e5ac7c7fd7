--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The self-test: measures what the virtual brick only assumes, and keeps the results as lines that
--  a host reads over USB. The display shows what is being done and what to plug in.

with Ada.Real_Time;  use Ada.Real_Time;
with Devices;
with Interrupt_Timing;
with Link_Timing;
with Memory_Timing;
with NXT.AVR;
with NXT.Display;    use NXT.Display;
with Results;
with Sequences;

procedure Main with Priority => 2 is

   use type NXT.Button_Id;

   Settling : constant Time_Span := Milliseconds (150);

   type Part is (Memory, Flash, Interrupts, Link, Supply, Motors, Touch, Sound, Clocks);

   --  The display is left alone while a part is measured.
   procedure Show (Item : Part) is
   begin
      Put_At_Noupdate (0, 7, "part ");
      Set_Pos (5, 7);
      Put_Noupdate (Integer'(Part'Pos (Item) + 1));
      Put_Noupdate (" of 9   ");
      Screen_Update;
      delay until Clock + Settling;
   end Show;

   procedure Perform (Item : Part) is
   begin
      Show (Item);
      case Item is
         when Memory     => Memory_Timing.Measure_RAM;
         when Flash      => Memory_Timing.Measure_Flash;
         when Interrupts => Interrupt_Timing.Measure;
         when Link       => Link_Timing.Measure;
         when Supply     => Devices.Measure_Supply;
         when Motors     => Devices.Measure_Motors;
         when Touch      => Devices.Ask_For_Touch;
         when Sound      => Devices.Measure_Sound;
         when Clocks     => Devices.Measure_Clocks;
      end case;
   end Perform;

   --  Time to plug in; the orange button ends it.
   procedure Await_Person is
      Patience : constant Time := Clock + Seconds (20);
   begin
      Put_At_Noupdate (0, 0, "SELF-TEST");
      Put_At_Noupdate (0, 1, "A B C: motors");
      Put_At_Noupdate (0, 2, "1: touch sensor");
      Put_At_Noupdate (0, 3, "or nothing");
      Put_At (0, 5, "Orange: go on");
      while NXT.AVR.Button /= NXT.Middle_Button and then Clock < Patience loop
         delay until Clock + Milliseconds (10);
      end loop;
      Put_At (0, 5, "             ");
   end Await_Person;

begin
   NXT.AVR.Await_Data_Available;
   Sequences.Prepare;
   for Item in Memory .. Supply loop
      Perform (Item);
   end loop;
   Results.Finish ("timing");
   Await_Person;
   for Item in Motors .. Clocks loop
      Perform (Item);
   end loop;
   Results.Finish ("test");
   Put_At_Noupdate (0, 5, "DONE.");
   Put_At (0, 7, "Keep USB plugged");
   delay until Time_Last;
end Main;
