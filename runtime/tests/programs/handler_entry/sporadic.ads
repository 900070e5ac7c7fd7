--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A sporadic task: it waits on the entry of an object whose interrupt handler opens it, and gets
--  the number of the interrupt as a parameter

package Sporadic is

   Served : Natural := 0 with Volatile, Export, Convention => C, External_Name => "served";
   --  Interrupts whose number arrived in order

   task Server with Priority => 20, Storage_Size => 768;
   task Background with Priority => 5, Storage_Size => 768;

end Sporadic;
