--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;

package body Equal_Tasks is

   task body Equal is
   begin
      delay until Time_Of (0, Milliseconds (20));
      delay until Time_Last;
   end Equal;

end Equal_Tasks;
