--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package Recursion is

   task Recursive_Task with Priority => 12, Storage_Size => 1024 is
      pragma Task_Name ("recursive");
   end Recursive_Task;
   --  Calls itself ever deeper, compiled with stack checking.

end Recursion;
