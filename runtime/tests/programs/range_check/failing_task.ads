--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A task that violates a range, and the hook that a driver would define

with System;

package Failing_Task is

   Hook_Message : System.Address
     with Volatile, Export, Convention => C, External_Name => "hook_message";
   Hook_Line : Integer := 0
     with Volatile, Export, Convention => C, External_Name => "hook_line";

   procedure Hook (Message : System.Address; Line : Integer)
     with Export, Convention => C, External_Name => "ravenbrick_last_chance_hook";

   task Counter with Priority => 10, Storage_Size => 512;

end Failing_Task;
