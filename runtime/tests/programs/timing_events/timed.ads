--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Events that repeat themselves, are set in the past, moved and cancelled

package Timed is

   Latest : Integer := 0
     with Volatile, Export, Convention => C, External_Name => "latest";
   --  Greatest lateness of the repeated event in units

   Repeated : Natural := 0
     with Volatile, Export, Convention => C, External_Name => "repeated";

   task User with Priority => 10, Storage_Size => 1024;
   task Server with Priority => 12, Storage_Size => 768;

end Timed;
