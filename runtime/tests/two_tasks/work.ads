--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package Work is
   Started : Boolean := False with Volatile, Export, Convention => C, External_Name => "started";
   A_Count : Integer := 0 with Volatile, Export, Convention => C, External_Name => "a_count";
   B_Count : Integer := 0 with Volatile, Export, Convention => C, External_Name => "b_count";

   task A with Priority => 10, Storage_Size => 512;
   task B with Priority => 9, Storage_Size => 768;
end Work;
