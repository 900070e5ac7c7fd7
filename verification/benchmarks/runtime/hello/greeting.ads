--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The smallest program with a periodic task; its size is measured

package Greeting is

   Count : Natural := 0
     with Volatile, Export, Convention => C, External_Name => "count";

   task Hello with Priority => 10, Storage_Size => 512;

end Greeting;
