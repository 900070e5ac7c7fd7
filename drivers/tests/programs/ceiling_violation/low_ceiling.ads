--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package Low_Ceiling is

   protected Shared with Priority => 10 is
      procedure Touch;
   private
      Count : Natural := 0;
   end Shared;

   task Climber with Priority => 12, Storage_Size => 1024 is
      pragma Task_Name ("climber");
   end Climber;

end Low_Ceiling;
