--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  One use of each feature whose code the size test weighs: tasks, delay until, a protected
--  object with an entry, a suspension object, an interrupt handler

with System;

package Everything is

   Turns : Natural := 0
     with Volatile, Export, Convention => C, External_Name => "turns";

   task Cyclic with Priority => 10, Storage_Size => 512;
   task Receiver with Priority => 12, Storage_Size => 512;
   task Server with Priority => 14, Storage_Size => 512;

   Level : constant System.Interrupt_Priority := System.Interrupt_Priority'First + 3;

end Everything;
