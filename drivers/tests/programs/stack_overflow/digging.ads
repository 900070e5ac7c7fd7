--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package Digging is

   task Digger with Priority => 12, Storage_Size => 1024 is
      pragma Task_Name ("digger");
   end Digger;
   --  Calls itself ever deeper, compiled with stack checking.

end Digging;
