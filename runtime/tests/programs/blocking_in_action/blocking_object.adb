--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;

with Journal; use Journal;

package body Blocking_Object is

   procedure Nap is
   begin
      delay until Clock + Milliseconds (1);
   end Nap;

   protected body Object is
      procedure Sleep is
      begin
         Note ('s');
         Nap;
         Note ('x');
      end Sleep;
   end Object;

   task body Sleeper is
   begin
      Nap;
      Object.Sleep;
   end Sleeper;

end Blocking_Object;
