--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;

package body Pair is

   Epoch : constant Time := Clock;

   protected Action with Priority => 30 is
      procedure Count;
   end Action;

   protected body Action is

      procedure Count is
      begin
         for Turn in 1 .. 100 loop
            First_Count := First_Count + 1;
         end loop;
      end Count;

   end Action;

   task body First is
   begin
      loop
         Action.Count;
         for Turn in 1 .. 20 loop
            First_Count := First_Count + 1;
         end loop;
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
