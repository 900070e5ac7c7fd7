--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;                use Ada.Real_Time;
with Ada.Real_Time.Timing_Events;  use Ada.Real_Time.Timing_Events;
with System;

package body Faults is

   Jobs_Before : constant := 24;
   Busy        : constant Time_Span := Milliseconds (21);

   procedure C_Access (Address : Integer)
     with Import, Convention => C, External_Name => "fault_access";
   procedure C_Undefined with Import, Convention => C, External_Name => "fault_undefined";
   procedure C_Mask (Bits : Integer)
     with Import, Convention => C, External_Name => "fault_mask";

   type Words is array (1 .. 8) of Integer with Volatile_Components;

   Jobs  : Natural := 0;
   Sink  : Integer := 20 with Volatile;
   Event : Timing_Event;

   protected Handlers with Priority => System.Interrupt_Priority'Last is
      procedure On_Time (Event : in out Timing_Event);
   end Handlers;

   function Is_Chosen (Kind : Fault) return Boolean is (Chosen = Fault'Pos (Kind));

   procedure Hang is
   begin
      Began := 1;
      loop
         Sink := Sink + 1;
         Sink := Sink - 1;
      end loop;
   end Hang;

   procedure Fail is
      type Small is range 0 .. 10;
   begin
      Sink := Integer (Small (Sink));
   end Fail;

   protected body Handlers is

      procedure On_Time (Event : in out Timing_Event) is
         pragma Unreferenced (Event);
      begin
         Began := 1;
         if Is_Chosen (Loop_In_Handler) then
            Hang;
         end if;
         Fail;
      end On_Time;

   end Handlers;

   function Recurse (Depth : Integer) return Integer with No_Inline;

   function Recurse (Depth : Integer) return Integer is
      Local : Words := (others => Depth);
   begin
      if Depth > 0 then
         Local (1) := Recurse (Depth - 1) + 1;
      end if;
      return Local (1) + Local (8);
   end Recurse;

   procedure Overrun_Period is
      Now : constant Time := Clock;
   begin
      while Clock < Now + Busy loop
         null;
      end loop;
   end Overrun_Period;

   procedure Do_Fault is
   begin
      case Fault'Val (Chosen) is
         when Exception_In_Task     => Fail;
         when Exception_In_Handler | Loop_In_Handler =>
            Set_Handler (Event, Clock, Handlers.On_Time'Access);
         when Overflow              => Sink := Recurse (1_000_000);
         when Loop_In_Task          => Hang;
         when Loop_Masked           => C_Mask (16#80#); Hang;
         when Loop_All_Masked       => C_Mask (16#C0#); Hang;
         when Data_Abort            => C_Access (16#40_0000#);
         when Undefined_Instruction => C_Undefined;
         when Overrun               => Overrun_Period;
         when Nothing | Task_Returns | Main_Returns | Loop_Before_Delay => null;
      end case;
   end Do_Fault;

   procedure Strike is
   begin
      Jobs := Jobs + 1;
      if Jobs = Jobs_Before then
         delay until Clock + Microseconds (Phase_Us);
         Began := Boolean'Pos
           (not Is_Chosen (Exception_In_Handler) and then not Is_Chosen (Loop_In_Handler));
         Do_Fault;
      elsif Jobs > Jobs_Before and then Is_Chosen (Overrun) then
         Do_Fault;
      end if;
   end Strike;

   function Ended return Boolean is (Is_Chosen (Task_Returns) and then Jobs >= Jobs_Before);

end Faults;
