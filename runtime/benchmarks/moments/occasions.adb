--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time.Timing_Events; use Ada.Real_Time, Ada.Real_Time.Timing_Events;
with System;

with Handshake;
with Series; use Series;

package body Occasions is

   type Event_Number is range 1 .. 4;

   Events : array (Event_Number) of Timing_Event;

   Whole_Count : constant Time_Span := (Tick * 2 ** 30) * 4;
   --  Until the clock's count of ticks begins again

   protected Bell with Interrupt_Priority => System.Interrupt_Priority'First is
      procedure Ring (Event : in out Timing_Event);
   private
      Count : Natural := 0;
   end Bell;

   protected body Bell is
      procedure Ring (Event : in out Timing_Event) is
         pragma Unreferenced (Event);
      begin
         Count := Count + 1;
      end Ring;
   end Bell;

   procedure Move_Last (To : Time) with No_Inline;
   procedure Cancel_Last with No_Inline;

   procedure Move_Last (To : Time) is
   begin
      Set_Handler (Events (Event_Number'Last), To, Bell.Ring'Access);
   end Move_Last;

   procedure Cancel_Last is
      Was_Set : Boolean;
   begin
      Cancel_Handler (Events (Event_Number'Last), Was_Set);
   end Cancel_Last;

   procedure Play is
      Wrap : constant Time := Time_Of (0, Whole_Count);
   begin
      Handshake.Send;
      delay until Wrap - Milliseconds (1);
      for Number in Event_Number loop
         Set_Handler
           (Events (Number),
            Wrap + Milliseconds (1) + Microseconds (100) * Integer (Number),
            Bell.Ring'Access);
      end loop;
      Spend (2_000);
      Move_Last (Wrap + Microseconds (1_600));
      Cancel_Last;
      Move_Last (Wrap + Microseconds (1_700));
      delay until Wrap + Milliseconds (3);
      Finished := True;
   end Play;

end Occasions;
