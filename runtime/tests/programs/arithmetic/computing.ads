--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Floating-point and 64-bit arithmetic in two tasks that preempt each other

with Interfaces;

package Computing is

   Sum_Of_Floats : Float := 0.0
     with Volatile, Export, Convention => C, External_Name => "sum_of_floats";
   Sum_Of_Doubles : Long_Float := 0.0
     with Volatile, Export, Convention => C, External_Name => "sum_of_doubles";
   Product : Interfaces.Integer_64 := 1
     with Volatile, Export, Convention => C, External_Name => "product";
   Rounds : Natural := 0 with Volatile, Export, Convention => C, External_Name => "rounds";
   Text : String (1 .. 12) := (others => ' ')
     with Volatile, Export, Convention => C, External_Name => "text";

   task Doubles with Priority => 10, Storage_Size => 1024;
   task Floats with Priority => 11, Storage_Size => 1024;

end Computing;
