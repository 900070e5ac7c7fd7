--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;

package body Pair is

   Epoch : constant Time := Clock;

   task body First is
   begin
      loop
         First_Count := First_Count + 1;
      end loop;
   end First;

   task body Second is
   begin
      loop
         Second_Count := Second_Count + 1;
      end loop;
   end Second;

   task body Ticker is
      Next : Time := Epoch;
   begin
      loop
         Tick_Count := Tick_Count + 1;
         Next := Next + Microseconds (500);
         delay until Next;
      end loop;
   end Ticker;

end Pair;
