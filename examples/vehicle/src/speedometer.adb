--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;

package body Speedometer is

   use Ada.Real_Time;
   use Quantities;

   procedure Start (This : out Meter; Now : NXT.Motor_Encoders.Reading) is
   begin
      This.Past := (others => Now);
      This.Oldest := 0;
   end Start;

   procedure Measure
     (This : in out Meter; Now : NXT.Motor_Encoders.Reading; Speeds : out Motor_Speeds)
   is
      Past    : NXT.Motor_Encoders.Reading renames This.Past (This.Oldest);
      Elapsed : constant Integer := (Now.Instant - Past.Instant) / Time_Span_Unit;
      Per_Degree : constant Degrees_Per_Second :=
        (1.0 / Time_Unit) / Degrees_Per_Second (Elapsed);
   begin
      for Motor in NXT.Motor_Id loop
         pragma Annotate (Ravenbrick, Iterations, 3, "the motors");
         Speeds (Motor) :=
           Degrees_Per_Second (Now.Counts (Motor) - Past.Counts (Motor)) * Per_Degree;
      end loop;
      Past := Now;
      This.Oldest := This.Oldest + 1;
   end Measure;

end Speedometer;
