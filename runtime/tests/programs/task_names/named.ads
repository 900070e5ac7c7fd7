--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package Named is

   Images : String (1 .. 4 * 16) := (others => ' ')
     with Volatile, Export, Convention => C, External_Name => "images";

   procedure Note (Place : Positive; Text : String);
   --  In columns of 16

   task With_Name with Priority => 10, Storage_Size => 512 is
      pragma Task_Name ("pilot");
   end With_Name;

   task Without_Name with Priority => 10, Storage_Size => 512;

end Named;
