--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A task without a deadline that ends after 20 ms, and a supervisor that is left alone

package Leaving is

   Main_Stays : Integer := -1
     with Volatile, Export, Convention => C, External_Name => "main_stays";
   --  1: the main procedure does not end; the test puts it into the image

   task Supervisor with Priority => 30, Storage_Size => 1_024;

   task Mortal with Priority => 10, Storage_Size => 1_024;

end Leaving;
