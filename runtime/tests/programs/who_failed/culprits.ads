--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Two tasks and a handler, of which one fails, and a hook that keeps what a display would show

with System;

package Culprits is

   type Culprit is (Pilot_Above_Ceiling, Nameless_Task, Handler_Of_TC1);

   Chosen : Integer := -1
     with Volatile, Export, Convention => C, External_Name => "chosen";
   --  Position of the culprit; the test puts it into the image

   Described : String (1 .. 4 * 24) := (others => ' ')
     with Volatile, Export, Convention => C, External_Name => "described";

   procedure Hook (Message : System.Address; Line : Integer)
     with Export, Convention => C, External_Name => "ravenbrick_last_chance_hook";

   task Pilot with Priority => 12, Storage_Size => 1_024 is
      pragma Task_Name ("pilot");
   end Pilot;

   task Nameless with Priority => 9, Storage_Size => 1_024;

   protected Low with Priority => 10 is
      procedure Touch;
   end Low;

end Culprits;
