--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Angles of the motors, read every millisecond, in symbols for an observer.

with Ada.Real_Time;       use Ada.Real_Time;
with NXT.Motor_Encoders;  use NXT.Motor_Encoders;

procedure Encoders is

   use NXT;

   Count_A : Integer := 0 with Volatile, Export, Convention => C, External_Name => "count_a";
   Count_B : Integer := 0 with Volatile, Export, Convention => C, External_Name => "count_b";
   Count_C : Integer := 0 with Volatile, Export, Convention => C, External_Name => "count_c";
   Unequal : Integer := 0 with Volatile, Export, Convention => C, External_Name => "unequal";
   --  Readings between which the time stood still.

   Next   : Time := Clock;
   Before : Reading := Current;
   Now    : Reading;
begin
   loop
      Next := Next + Milliseconds (1);
      delay until Next;
      Now := Current;
      Count_A := Now.Counts (Motor_A);
      Count_B := Now.Counts (Motor_B);
      Count_C := Encoder_Count (Motor_C);
      if Now.Instant <= Before.Instant then
         Unequal := Unequal + 1;
      end if;
      Before := Now;
   end loop;
end Encoders;
