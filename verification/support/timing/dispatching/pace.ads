--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The period of the main procedures here, and its number, which the compiler does not know

with Ada.Real_Time;

package Pace is

   Count : Natural := 0 with Volatile;
   --  From 0 to 49, then from 0 again

   function Next return Ada.Real_Time.Time;
   --  The next release; begins the next number

end Pace;
