--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts.Names; use Ada.Interrupts.Names;
with Ada.Real_Time; use Ada.Real_Time;

with Cells; use Cells;
with Checks; use Checks;
with Timers; use Timers;

package body Contenders is

   use type Checks.Word;
   use type Random_Numbers.Word;

   First_Level : constant System.Interrupt_Priority := System.Interrupt_Priority'First;

   Of_Workers : Cell (14);
   Of_Server  : Cell (20);
   Of_Low     : aliased Cell (First_Level + 2);
   Of_Middle  : Cell (First_Level + 3);
   Of_High    : aliased Cell (First_Level + 5);
   Of_All     : aliased Cell (First_Level + 6);

   Workers_And_Low : Outer_Cell (14, Of_Low'Access);
   Server_And_All  : Outer_Cell (20, Of_All'Access);
   Low_And_High    : Outer_Cell (First_Level + 2, Of_High'Access);

   Low_Numbers  : Generator;
   High_Numbers : Generator;

   protected Low_Handler with Interrupt_Priority => First_Level + 2 is
      procedure Handle with Attach_Handler => TC1;
   end Low_Handler;

   protected High_Handler with Interrupt_Priority => First_Level + 5 is
      procedure Handle with Attach_Handler => TC2;
      entry Wait;
   private
      Is_Due : Boolean := False;
   end High_Handler;

   procedure Count (Who : Positive) is
   begin
      Touched (Who) := Touched (Who) + 1;
   end Count;

   protected body Low_Handler is
      procedure Handle is
         Turns : constant Random_Numbers.Word := Next (Low_Numbers, 8);
      begin
         Acknowledge (Timers.Channel_1);
         case Next (Low_Numbers, 4) is
            when 0      => Of_Low.Touch (Turns, By_Task => False);
            when 1      => Of_Middle.Touch (Turns, By_Task => False);
            when 2      => Of_High.Touch (Turns, By_Task => False);
            when others => Of_All.Touch (Turns, By_Task => False);
         end case;
         Count (5);
         Start_Once (Timers.Channel_1, 400 + Timers.Word (Next (Low_Numbers, 3_000)));
      end Handle;
   end Low_Handler;

   protected body High_Handler is

      procedure Handle is
         Turns : constant Random_Numbers.Word := Next (High_Numbers, 6);
      begin
         Acknowledge (Timers.Channel_2);
         if Next (High_Numbers, 2) = 0 then
            Of_High.Touch (Turns, By_Task => False);
         else
            Of_All.Touch (Turns, By_Task => False);
         end if;
         Count (6);
         if not Is_Due then
            Is_Due := True;
            Server_Is_Due := True;
            Requests := Requests + 1;
         end if;
         Start_Once (Timers.Channel_2, 600 + Timers.Word (Next (High_Numbers, 5_000)));
      end Handle;

      entry Wait when Is_Due is
      begin
         Is_Due := False;
      end Wait;

   end High_Handler;

   procedure Check_Outside is
   begin
      Hold (All_Enabled, Enabled = (Alarm or Low or High));
      Hold (Most_Urgent, not Server_Is_Due);
   end Check_Outside;

   procedure Contend (Numbers : in out Generator; Who : Positive) is
      Turns : constant Random_Numbers.Word := Next (Numbers, 10);
   begin
      case Next (Numbers, 10) is
         when 0      => Of_Workers.Touch (Turns, By_Task => True);
         when 1      => Of_Server.Touch (Turns, By_Task => True);
         when 2      => Of_Low.Touch (Turns, By_Task => True);
         when 3      => Of_Middle.Touch (Turns, By_Task => True);
         when 4      => Of_High.Touch (Turns, By_Task => True);
         when 5      => Of_All.Touch (Turns, By_Task => True);
         when 6      => Workers_And_Low.Touch (Turns);
         when 7      => Server_And_All.Touch (Turns);
         when 8      => Low_And_High.Touch (Turns);
         when others => delay until Clock + Microseconds (Integer (10 * Turns));
      end case;
      Check_Outside;
      Spend (Next (Numbers, 20));
      Check_Outside;
      Count (Who);
   end Contend;

   task body Worker is
      Numbers : Generator;
   begin
      Start (Numbers, Number);
      delay until Time_Of (0, Milliseconds (2));
      loop
         for Turn in 1 .. 20 loop
            Contend (Numbers, Positive (Number));
         end loop;
         delay until Clock + Microseconds (100 + Integer (Next (Numbers, 300)));
      end loop;
   end Worker;

   task body Server is
   begin
      Start (Low_Numbers, 5);
      Start (High_Numbers, 6);
      Start_Once (Timers.Channel_1, 5_000);
      Start_Once (Timers.Channel_2, 7_000);
      loop
         High_Handler.Wait;
         Server_Is_Due := False;
         Hold (All_Enabled, Enabled = (Alarm or Low or High));
         Of_Server.Touch (1, By_Task => True);
         Served := Served + 1;
      end loop;
   end Server;

end Contenders;
