--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Unchecked_Conversion;

with Ravenbrick.Clock;

package body Ada.Calendar is

   subtype Wide is Long_Long_Integer;

   function To_Wide is new Ada.Unchecked_Conversion (Duration, Wide);
   function To_Duration is new Ada.Unchecked_Conversion (Wide, Duration);
   --  Duration counts nanoseconds

   Nanoseconds_Per_Day : constant Time := 86_400_000_000_000;

   --  Dates are those of the Gregorian calendar, counted in days from 1 March of the year 0: a year
   --  that begins in March ends with the day that not every year has

   Days_Per_Year    : constant := 365;
   Days_Per_4_Years : constant := 4 * Days_Per_Year + 1;
   Days_Per_Century : constant := 25 * Days_Per_4_Years - 1;
   Days_Per_Cycle   : constant := 4 * Days_Per_Century + 1;

   function Day_Count (Year : Integer; Month : Month_Number; Day : Day_Number) return Integer;
   --  Days from 1 March 0

   function Is_Leap (Year : Year_Number) return Boolean is
     (Year mod 4 = 0 and then (Year mod 100 /= 0 or else Year mod 400 = 0));

   function Month_Length (Year : Year_Number; Month : Month_Number) return Day_Number is
     (case Month is
         when 4 | 6 | 9 | 11 => 30,
         when 2 => (if Is_Leap (Year) then 29 else 28),
         when others => 31);

   function Day_Count (Year : Integer; Month : Month_Number; Day : Day_Number) return Integer is
      From_March   : constant Integer := (Month + 9) mod 12;
      Year_Of_March : constant Integer := (if Month <= 2 then Year - 1 else Year);
   begin
      return Year_Of_March * Days_Per_Year
        + Year_Of_March / 4 - Year_Of_March / 100 + Year_Of_March / 400
        + (153 * From_March + 2) / 5 + Day - 1;
   end Day_Count;

   Origin : constant Integer := Day_Count (2150, 1, 1);
   First  : constant Time := Time (Day_Count (1901, 1, 1) - Origin) * Nanoseconds_Per_Day;
   Beyond : constant Time := Time (Day_Count (2400, 1, 1) - Origin) * Nanoseconds_Per_Day;
   --  The dates are at or after First and before Beyond

   function Checked (Date : Wide) return Time;
   --  Time_Error when Date is outside

   function Checked (Date : Wide) return Time is
   begin
      if Time (Date) < First or else Time (Date) >= Beyond then
         raise Time_Error;
      end if;
      return Time (Date);
   end Checked;

   function Clock return Time is
      Units_Per_Second : constant := 21_024_000;
      Now   : constant Wide := Wide (Ravenbrick.Clock.Now);
      Whole : constant Wide := Now / Units_Per_Second;
      Part  : constant Wide := Now mod Units_Per_Second;
   begin
      return Start + Time (Whole * 1_000_000_000 + Part * 31_250 / 657);
   end Clock;

   procedure Split
     (Date    : Time;
      Year    : out Year_Number;
      Month   : out Month_Number;
      Day     : out Day_Number;
      Seconds : out Day_Duration)
   is
      In_Day     : constant Time := Date mod Nanoseconds_Per_Day;
      Days       : constant Integer := Integer ((Date - In_Day) / Nanoseconds_Per_Day) + Origin;
      Cycle      : constant Integer := Days / Days_Per_Cycle;
      Rest       : Integer := Days mod Days_Per_Cycle;
      Centuries  : constant Integer := Integer'Min (Rest / Days_Per_Century, 3);
      Quads      : Integer;
      Years      : Integer;
      From_March : Integer;
   begin
      Rest := Rest - Centuries * Days_Per_Century;
      Quads := Rest / Days_Per_4_Years;
      Rest := Rest mod Days_Per_4_Years;
      Years := Integer'Min (Rest / Days_Per_Year, 3);
      Rest := Rest - Years * Days_Per_Year;
      From_March := (5 * Rest + 2) / 153;
      Day := Rest - (153 * From_March + 2) / 5 + 1;
      Month := (From_March + 2) mod 12 + 1;
      Year := 400 * Cycle + 100 * Centuries + 4 * Quads + Years + (if Month <= 2 then 1 else 0);
      Seconds := To_Duration (Wide (In_Day));
   end Split;

   function Year (Date : Time) return Year_Number is
      Result : Year_Number;
      M      : Month_Number;
      D      : Day_Number;
      S      : Day_Duration;
   begin
      Split (Date, Result, M, D, S);
      return Result;
   end Year;

   function Month (Date : Time) return Month_Number is
      Y      : Year_Number;
      Result : Month_Number;
      D      : Day_Number;
      S      : Day_Duration;
   begin
      Split (Date, Y, Result, D, S);
      return Result;
   end Month;

   function Day (Date : Time) return Day_Number is
      Y      : Year_Number;
      M      : Month_Number;
      Result : Day_Number;
      S      : Day_Duration;
   begin
      Split (Date, Y, M, Result, S);
      return Result;
   end Day;

   function Seconds (Date : Time) return Day_Duration is
     (To_Duration (Wide (Date mod Nanoseconds_Per_Day)));

   function Time_Of
     (Year    : Year_Number;
      Month   : Month_Number;
      Day     : Day_Number;
      Seconds : Day_Duration := 0.0) return Time is
   begin
      if Day > Month_Length (Year, Month) then
         raise Time_Error;
      end if;
      return Checked
        (Wide (Time (Day_Count (Year, Month, Day) - Origin) * Nanoseconds_Per_Day)
         + To_Wide (Seconds));
   end Time_Of;

   --  The sum of a date and a duration is outside the dates long before it leaves 64 bits, but for
   --  durations near the ends of their type

   pragma Unsuppress (Overflow_Check);

   function "+" (Left : Time; Right : Duration) return Time is
   begin
      return Checked (Wide (Left) + To_Wide (Right));
   exception
      when Constraint_Error => raise Time_Error;
   end "+";

   function "+" (Left : Duration; Right : Time) return Time is (Right + Left);

   function "-" (Left : Time; Right : Duration) return Time is
   begin
      return Checked (Wide (Left) - To_Wide (Right));
   exception
      when Constraint_Error => raise Time_Error;
   end "-";

   function "-" (Left : Time; Right : Time) return Duration is
   begin
      return To_Duration (Wide (Left) - Wide (Right));
   exception
      when Constraint_Error => raise Time_Error;
   end "-";

   function From_Start (Date : Time) return Duration is (Date - Start);

begin
   Start := Time_Of (2000, 1, 1);
end Ada.Calendar;
