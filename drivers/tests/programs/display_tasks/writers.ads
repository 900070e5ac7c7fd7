--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Two tasks that write at places of their own, and one that updates the display without a pause.

package Writers is

   Rounds_Of_Upper : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "rounds_of_upper";

   Longest_Update_Us : Integer := 0 with
     Volatile, Export, Convention => C, External_Name => "longest_update_us";

   procedure Keep_Updating;

private

   task Upper with Priority => 5, Storage_Size => 2_048;
   task Lower with Priority => 4, Storage_Size => 2_048;

end Writers;
