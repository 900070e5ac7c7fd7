--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;

package body Pace is

   Release : Time := Clock + Milliseconds (20);

   function Next return Time is
      Now : constant Time := Release;
   begin
      Release := Now + Milliseconds (4);
      Count := (Count + 1) mod 50;
      return Now;
   end Next;

end Pace;
