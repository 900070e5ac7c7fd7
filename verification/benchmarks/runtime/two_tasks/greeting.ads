--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Two tasks that share a protected object with an entry; its size is measured

package Greeting is

   Count : Natural := 0
     with Volatile, Export, Convention => C, External_Name => "count";

   task Sender with Priority => 10, Storage_Size => 512;
   task Receiver with Priority => 11, Storage_Size => 512;

end Greeting;
