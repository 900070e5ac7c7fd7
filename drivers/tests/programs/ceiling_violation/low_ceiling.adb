--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;

package body Low_Ceiling is

   protected body Shared is
      procedure Touch is
      begin
         Count := Count + 1;
      end Touch;
   end Shared;

   task body Climber is
   begin
      delay until Time_Of (0, Milliseconds (100));
      Shared.Touch;
   end Climber;

end Low_Ceiling;
