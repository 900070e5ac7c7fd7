--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Unchecked_Conversion;

with Ravenbrick.Clock;

package body Ada.Real_Time is

   pragma Unsuppress (Overflow_Check);
   pragma Unsuppress (Range_Check);
   --  An unrepresentable result raises Constraint_Error, as for predefined arithmetic

   subtype Wide is Long_Long_Integer;

   --  A unit is 31_250 / 657 ns
   Nanoseconds_Numerator   : constant := 31_250;
   Nanoseconds_Denominator : constant := 657;

   function To_Wide is new Ada.Unchecked_Conversion (Duration, Wide);
   function To_Duration is new Ada.Unchecked_Conversion (Wide, Duration);
   --  Duration counts nanoseconds

   function Rounded_Ratio (Value, Numerator, Denominator : Wide) return Wide;
   --  Value * Numerator / Denominator to the nearest, halves away from zero. The whole part is
   --  scaled apart from the remainder, so that only an unrepresentable result overflows.

   function Rounded_Ratio (Value, Numerator, Denominator : Wide) return Wide is
      Whole : constant Wide := Value / Denominator;
      Part  : constant Wide := (Value rem Denominator) * Numerator;
      Half  : constant Wide := Denominator / 2;
   begin
      return Whole * Numerator
        + (if Part >= 0 then (Part + Half) / Denominator else (Part - Half) / Denominator);
   end Rounded_Ratio;

   function Clock return Time is (Time (Ravenbrick.Clock.Now));

   function "+" (Left : Time; Right : Time_Span) return Time is
     (Time (Wide (Left) + Wide (Right)));
   function "+" (Left : Time_Span; Right : Time) return Time is
     (Time (Wide (Left) + Wide (Right)));
   function "-" (Left : Time; Right : Time_Span) return Time is
     (Time (Wide (Left) - Wide (Right)));
   function "-" (Left : Time; Right : Time) return Time_Span is
     (Time_Span (Wide (Left) - Wide (Right)));

   function "+" (Left, Right : Time_Span) return Time_Span is
     (Time_Span (Wide (Left) + Wide (Right)));
   function "-" (Left, Right : Time_Span) return Time_Span is
     (Time_Span (Wide (Left) - Wide (Right)));
   function "-" (Right : Time_Span) return Time_Span is (Time_Span (-Wide (Right)));

   function "*" (Left : Time_Span; Right : Integer) return Time_Span is
     (Time_Span (Wide (Left) * Wide (Right)));
   function "*" (Left : Integer; Right : Time_Span) return Time_Span is
     (Time_Span (Wide (Left) * Wide (Right)));
   function "/" (Left, Right : Time_Span) return Integer is
     (Integer (Wide (Left) / Wide (Right)));
   function "/" (Left : Time_Span; Right : Integer) return Time_Span is
     (Time_Span (Wide (Left) / Wide (Right)));

   function To_Duration (TS : Time_Span) return Duration is
     (To_Duration
        (Rounded_Ratio (Wide (TS), Nanoseconds_Numerator, Nanoseconds_Denominator)));

   function To_Time_Span (D : Duration) return Time_Span is
     (Time_Span
        (Rounded_Ratio (To_Wide (D), Nanoseconds_Denominator, Nanoseconds_Numerator)));

   function Nanoseconds (NS : Integer) return Time_Span is
     (Time_Span
        (Rounded_Ratio (Wide (NS), Nanoseconds_Denominator, Nanoseconds_Numerator)));

   function Microseconds (US : Integer) return Time_Span is
     (Time_Span (Rounded_Ratio (Wide (US), Units_Per_Millisecond, 1_000)));

   --  The products of the following three fit: no Integer is too large

   pragma Suppress (Overflow_Check);

   function Milliseconds (MS : Integer) return Time_Span is
     (Time_Span (Wide (MS) * Units_Per_Millisecond));
   function Seconds (S : Integer) return Time_Span is (Time_Span (Wide (S) * Units_Per_Second));
   function Minutes (M : Integer) return Time_Span is
     (Time_Span (Wide (M) * (60 * Units_Per_Second)));

   pragma Unsuppress (Overflow_Check);

   procedure Split (T : Time; SC : out Seconds_Count; TS : out Time_Span) is
      Part : constant Wide := Wide (T) mod Units_Per_Second;
   begin
      SC := Seconds_Count ((Wide (T) - Part) / Units_Per_Second);
      TS := Time_Span (Part);
   end Split;

   function Time_Of (SC : Seconds_Count; TS : Time_Span) return Time is
     (Time (Wide (SC) * Units_Per_Second + Wide (TS)));

end Ada.Real_Time;
