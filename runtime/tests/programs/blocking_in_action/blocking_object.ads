--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A delay inside a protected procedure whose ceiling is its caller's priority (RM 9.5.1)

package Blocking_Object is

   protected Object with Priority => 10 is
      procedure Sleep;
   end Object;

   task Sleeper with Priority => 10, Storage_Size => 512;

end Blocking_Object;
