--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;                 use Ada.Real_Time;
with Ada.Real_Time.Timing_Events;   use Ada.Real_Time.Timing_Events;
with NXT.AVR;
with NXT.Motor_Controls;
with System;

package body Failing is

   pragma Assertion_Policy (Check);

   type Small is range 0 .. 10;
   type Words is array (Natural range <>) of Integer with Volatile_Components;

   function C_Access (Address : Integer) return Integer
     with Import, Convention => C, External_Name => "failing_access";
   function C_Undefined return Integer
     with Import, Convention => C, External_Name => "failing_undefined";
   function C_Jump (Target : Integer) return Integer
     with Import, Convention => C, External_Name => "failing_jump";

   Sink : Integer := 20 with Volatile;
   Four : Words (1 .. 4) := (others => 0);

   protected Low with Priority => System.Priority'First is
      procedure Touch;
   end Low;

   protected High with Priority => System.Interrupt_Priority'Last is
      procedure Fail;
      procedure On_Time (Event : in out Timing_Event);
   end High;

   Event : Timing_Event;

   function Recurse (Depth : Integer) return Integer with No_Inline;

   function Recurse (Depth : Integer) return Integer is
      Local : Words (1 .. 4) := (others => Depth);
   begin
      if Depth > 0 then
         Local (1) := Recurse (Depth - 1) + 1;
      end if;
      return Local (1) + Local (4);
   end Recurse;

   function Large return Integer with No_Inline;

   function Large return Integer is  --  the large frame
      Local : Words (1 .. 1500);
   begin
      Local (1) := Sink;
      Local (1500) := Sink;
      return Local (1) + Local (1500);
   end Large;

   function Sized (Length : Integer) return Integer with No_Inline;

   function Sized (Length : Integer) return Integer is
      Local : Words (1 .. Length);  --  the sized array
   begin
      Local (1) := Length;
      Local (Length) := Length;
      return Local (1) + Recurse (1);
   end Sized;

   protected body Low is
      procedure Touch is
      begin
         Sink := Sink + 1;
      end Touch;
   end Low;

   protected body High is

      procedure Fail is
      begin
         Four (Sink) := 1;  --  in the protected procedure
      end Fail;

      procedure On_Time (Event : in out Timing_Event) is
         pragma Unreferenced (Event);
      begin
         if Way'Val (Chosen) = Handler_Recursion then
            Sink := Recurse (Amount);
         else
            Four (Sink) := 1;  --  in the handler
         end if;
      end On_Time;

   end High;

   procedure Fail_With_Exception (Chosen : Way) is
   begin
      case Chosen is
         when Range_Check =>
            Sink := Integer (Small (Sink));  --  the range check
         when Index_Check =>
            Four (Sink) := 1;  --  the index check
         when Overflow =>
            Sink := Integer'Last - 5 + Sink;  --  the overflow
         when Division =>
            Sink := 5 / (Sink - 20);  --  the division
         when Raised =>
            raise Program_Error;  --  the raise statement
         when Raised_With_Message =>
            raise Too_Hot with "98 degrees";  --  the raise with a message
         when Own_Exception =>
            raise Too_Hot;  --  the own exception
         when Storage =>
            raise Storage_Error;  --  the storage error
         when others =>
            pragma Assert (Sink = 19);  --  the assertion
      end case;
   end Fail_With_Exception;

   procedure Go (Called_By : Integer) is
   begin
      if Called_By /= The_Task then
         return;
      end if;
      case Way'Val (Chosen) is
         when Nothing             => null;
         when Recursion           => Sink := Recurse (1_000_000);
         when Deep_Calls          => Sink := Recurse (Amount);
         when Large_Array         => Sink := Large;
         when Sized_Array         => Sink := Sized (Amount);
         when No_Memory           => Sink := C_Access (16#40_0000#);
         when Misaligned          => Sink := C_Access (16#20_9001#);
         when Undefined           => Sink := C_Undefined;
         when Wild_Jump           => Sink := C_Jump (16#50_0000#);
         when In_Protected        => High.Fail;
         when Ceiling             => Low.Touch;  --  the ceiling violation
         when In_Handler | Handler_Recursion =>
            Set_Handler (Event, Clock + Milliseconds (1), High.On_Time'Access);
         when Read_Early          => Sink := Integer (NXT.AVR.Reading (NXT.Sensor_2));
         when Drive               => NXT.Motor_Controls.Drive (NXT.Motor_B, 30);
         when others              => Fail_With_Exception (Way'Val (Chosen));
      end case;
   end Go;

end Failing;
