--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;               use Ada.Real_Time;
with Ada.Real_Time.Timing_Events; use Ada.Real_Time.Timing_Events;
with System;

with Mixing; use Mixing;

package body Workers is

   Heartbeat : Timing_Event;
   Timeout   : Timing_Event;

   Epoch : constant Time := Clock + Milliseconds (20);

   protected Bell with Interrupt_Priority => System.Interrupt_Priority'First is
      procedure Start;
      procedure Beat (Event : in out Timing_Event);
      procedure Expire (Event : in out Timing_Event);
      entry Wait;
   private
      Next    : Time := Epoch;
      Expired : Boolean := False;
   end Bell;

   protected body Bell is

      procedure Start is
      begin
         Set_Handler (Heartbeat, Next, Beat'Access);
      end Start;

      procedure Beat (Event : in out Timing_Event) is
      begin
         Mix (40);
         Next := Next + Microseconds (2_500);
         Set_Handler (Event, Next, Beat'Access);
      end Beat;

      procedure Expire (Event : in out Timing_Event) is
         pragma Unreferenced (Event);
      begin
         Mix (10);
         Expired := True;
      end Expire;

      entry Wait when Expired is
      begin
         Expired := False;
      end Wait;

   end Bell;

   task body Control is
      Next : Time := Epoch;
   begin
      Bell.Start;
      loop
         delay until Next;
         Mix (800);
         Set_Handler (Timeout, Next + Microseconds (1_700), Bell.Expire'Access);
         Mix (200);
         Next := Next + Milliseconds (4);
      end loop;
   end Control;

   task body Server is
   begin
      loop
         Bell.Wait;
         Mix (300);
      end loop;
   end Server;

   task body Display is
      Next : Time := Epoch;
   begin
      loop
         delay until Next;
         Mix (20_000);
         Next := Next + Milliseconds (50);
      end loop;
   end Display;

end Workers;
