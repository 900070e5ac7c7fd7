--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Monotonic time (Ada RM D.8). Time counts units of 1/21_024_000 s: a millisecond is exactly
--  21_024 of them and a tick of the clock exactly 7, so that periods neither drift nor round.

private with Ravenbrick.Threads;

package Ada.Real_Time is

   Units_Per_Second : constant := 21_024_000;

   type Time is private;
   Time_First : constant Time;
   Time_Last  : constant Time;
   Time_Unit  : constant := 1.0 / Units_Per_Second;

   type Time_Span is private;
   Time_Span_First : constant Time_Span;
   Time_Span_Last  : constant Time_Span;
   Time_Span_Zero  : constant Time_Span;
   Time_Span_Unit  : constant Time_Span;

   Tick : constant Time_Span;
   --  Between two changes of Clock: 16 cycles of the processor, 333 ns

   function Clock return Time with Volatile_Function;
   --  Time since the run-time started

   function "+" (Left : Time; Right : Time_Span) return Time;
   function "+" (Left : Time_Span; Right : Time) return Time;
   function "-" (Left : Time; Right : Time_Span) return Time;
   function "-" (Left : Time; Right : Time) return Time_Span;

   function "<"  (Left, Right : Time) return Boolean;
   function "<=" (Left, Right : Time) return Boolean;
   function ">"  (Left, Right : Time) return Boolean;
   function ">=" (Left, Right : Time) return Boolean;

   function "+"   (Left, Right : Time_Span) return Time_Span;
   function "-"   (Left, Right : Time_Span) return Time_Span;
   function "-"   (Right : Time_Span) return Time_Span;
   function "*"   (Left : Time_Span; Right : Integer) return Time_Span;
   function "*"   (Left : Integer; Right : Time_Span) return Time_Span;
   function "/"   (Left, Right : Time_Span) return Integer;
   function "/"   (Left : Time_Span; Right : Integer) return Time_Span;
   function "abs" (Right : Time_Span) return Time_Span;

   function "<"  (Left, Right : Time_Span) return Boolean;
   function "<=" (Left, Right : Time_Span) return Boolean;
   function ">"  (Left, Right : Time_Span) return Boolean;
   function ">=" (Left, Right : Time_Span) return Boolean;

   function To_Duration  (TS : Time_Span) return Duration;
   --  Rounded to the nearest nanosecond; Constraint_Error outside Duration

   function To_Time_Span (D : Duration) return Time_Span;
   --  Rounded to the nearest unit

   function Nanoseconds  (NS : Integer) return Time_Span;
   --  Rounded to the nearest unit

   function Microseconds (US : Integer) return Time_Span;
   --  Exact for multiples of 125, otherwise rounded to the nearest unit

   function Milliseconds (MS : Integer) return Time_Span;
   function Seconds      (S : Integer) return Time_Span;
   function Minutes      (M : Integer) return Time_Span;
   --  Exact

   type Seconds_Count is range -2 ** 63 / Units_Per_Second .. 2 ** 63 / Units_Per_Second;

   procedure Split (T : Time; SC : out Seconds_Count; TS : out Time_Span);
   --  T is SC seconds plus TS, and TS is not negative and shorter than a second

   function Time_Of (SC : Seconds_Count; TS : Time_Span) return Time;

private

   type Time is new Ravenbrick.Threads.Units;
   type Time_Span is new Ravenbrick.Threads.Units;

   Time_First : constant Time := Time'First;
   Time_Last  : constant Time := Time'Last;

   Time_Span_First : constant Time_Span := Time_Span'First;
   Time_Span_Last  : constant Time_Span := Time_Span'Last;
   Time_Span_Zero  : constant Time_Span := 0;
   Time_Span_Unit  : constant Time_Span := 1;

   Tick : constant Time_Span := 7;

   pragma Import (Intrinsic, "<");
   pragma Import (Intrinsic, "<=");
   pragma Import (Intrinsic, ">");
   pragma Import (Intrinsic, ">=");
   pragma Import (Intrinsic, "abs");

   Units_Per_Millisecond : constant := Units_Per_Second / 1_000;

end Ada.Real_Time;
