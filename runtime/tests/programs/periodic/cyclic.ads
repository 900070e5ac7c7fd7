--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Cyclic tasks whose periods are whole, fractional and coprime milliseconds

with Interfaces;

package Cyclic is

   Jobs : array (1 .. 4) of Natural := (others => 0)
     with Volatile_Components, Export, Convention => C, External_Name => "jobs";

   Latest_Lateness : array (1 .. 4) of Interfaces.Integer_32 := (others => 0)
     with Volatile_Components, Export, Convention => C, External_Name => "lateness";
   --  Greatest distance of Clock from the wake-up time after a delay, in units

   task One with Priority => 14, Storage_Size => 640;
   task Two with Priority => 13, Storage_Size => 640;
   task Three with Priority => 12, Storage_Size => 640;
   task Four with Priority => 11, Storage_Size => 640;

end Cyclic;
