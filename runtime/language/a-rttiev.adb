--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Unchecked_Conversion;
with System;

with Ravenbrick.Delays.Events;
with Ravenbrick.Processor; use Ravenbrick.Processor;

package body Ada.Real_Time.Timing_Events is

   package Events renames Ravenbrick.Delays.Events;

   subtype Units is Ravenbrick.Threads.Units;

   type Event_Reference is access all Timing_Event;

   function To_Event is new Ada.Unchecked_Conversion (System.Address, Event_Reference);

   procedure Expire (Alarm : not null Ravenbrick.Threads.Thread_Id; Previous : Status)
     with Convention => C;

   function Is_Set (Event : Timing_Event) return Boolean is
     (System."/=" (Event.Alarm.Entry_Parameters, System.Null_Address));
   --  With interrupts masked, when a comparison of both words of the handler would be a call of
   --  memcmp in Thumb code, up to 110 cycles; Is_Null is for the same reason

   type Address_Pair is record
      Object, Code : System.Address;
   end record;

   function To_Pair is new Ada.Unchecked_Conversion (Timing_Event_Handler, Address_Pair);

   function Is_Null (Handler : Timing_Event_Handler) return Boolean is
     (System."=" (To_Pair (Handler).Code, System.Null_Address))
     with Inline_Always;

   procedure Clear (Event : in out Timing_Event);
   --  Interrupts are masked

   procedure Clear (Event : in out Timing_Event) is
   begin
      if Is_Set (Event) then
         Event.Handler := null;
         Event.Alarm.Entry_Parameters := System.Null_Address;
         Events.Cancel (Event.Alarm'Unchecked_Access);
      end if;
   end Clear;

   procedure Set_Handler
     (Event : in out Timing_Event; At_Time : Time; Handler : Timing_Event_Handler)
   is
      Previous : Status;
   begin
      Mask_Interrupts (Previous);
      Clear (Event);
      if not Is_Null (Handler) then
         Event.Handler := Handler;
         Event.Alarm.Entry_Parameters := Event'Address;
         Events.Set (Event.Alarm'Unchecked_Access, Units (At_Time));
      end if;
      Restore_Interrupts (Previous);
   end Set_Handler;

   procedure Set_Handler
     (Event : in out Timing_Event; In_Time : Time_Span; Handler : Timing_Event_Handler) is
   begin
      Set_Handler (Event, Clock + In_Time, Handler);
   end Set_Handler;

   function Current_Handler (Event : Timing_Event) return Timing_Event_Handler is
     (Event.Handler);

   procedure Cancel_Handler (Event : in out Timing_Event; Cancelled : out Boolean) is
      Previous : Status;
   begin
      Mask_Interrupts (Previous);
      Cancelled := Is_Set (Event);
      Clear (Event);
      Restore_Interrupts (Previous);
   end Cancel_Handler;

   function Time_Of_Event (Event : Timing_Event) return Time is
     (if not Is_Set (Event) then Time_First else Time (Event.Alarm.Wake));

   --  The event is clear when its handler is called, which may set it again

   procedure Expire (Alarm : not null Ravenbrick.Threads.Thread_Id; Previous : Status) is
      Event   : constant not null Event_Reference := To_Event (Alarm.Entry_Parameters);
      Handler : constant Timing_Event_Handler := Event.Handler;
   begin
      Event.Handler := null;
      Event.Alarm.Entry_Parameters := System.Null_Address;
      Restore_Interrupts (Previous);
      Handler (Event.all);
   end Expire;

begin
   Events.Initialize (Expire'Access);
end Ada.Real_Time.Timing_Events;
