--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Two busy tasks of one priority and two periodic ones above them, which are released together: a
--  preempted task goes on before its equals (RM D.2.3(10)), also with two more urgent ones ready,
--  in a protected action of the ceiling 30 and outside of it

with System;

package Pair is

   First_Count : Natural := 0 with Volatile, Export, Convention => C, External_Name => "first";
   Second_Count : Natural := 0 with Volatile, Export, Convention => C, External_Name => "second";
   Tick_Count : Natural := 0 with Volatile, Export, Convention => C, External_Name => "ticks";

   task First with Priority => 10, Storage_Size => 512;
   task Second with Priority => 10, Storage_Size => 512;

   task type Ticker (Urgency : System.Priority) with Priority => Urgency, Storage_Size => 512;

   Less_Urgent : Ticker (20);
   More_Urgent : Ticker (30);

end Pair;
