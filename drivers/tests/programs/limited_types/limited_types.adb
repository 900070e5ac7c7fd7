--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Objects of a limited type that a function makes, as course programs like to have them.

with Ada.Real_Time;
with Counters;  use Counters;

procedure Limited_Types is

   Total : Integer := -1 with Volatile, Export, Convention => C, External_Name => "total";

   First  : Counter := Make (40);
   Second : constant Counter := Make (1);
begin
   First.Add (Second);
   First.Add (Second);
   Total := First.Value;
   delay until Ada.Real_Time.Time_Last;
end Limited_Types;
