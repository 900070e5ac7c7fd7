--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;

with Mixing; use Mixing;

package body Workers is

   Epoch : constant Time := Clock + Milliseconds (20);

   protected Shared with Priority => 12 is
      procedure Hold (Rounds : Positive);
   end Shared;

   protected body Shared is
      procedure Hold (Rounds : Positive) is
      begin
         Mix (Rounds);
      end Hold;
   end Shared;

   task body Control is
      Next : Time := Epoch;
   begin
      loop
         delay until Next;
         Mix (400);
         Shared.Hold (10);
         Next := Next + Milliseconds (4);
      end loop;
   end Control;

   task body Display is
      Next : Time := Epoch;
   begin
      loop
         delay until Next;
         Mix (20_000);
         Next := Next + Milliseconds (50);
      end loop;
   end Display;

   procedure Do_Nothing is
   begin
      loop
         null;
      end loop;
   end Do_Nothing;

   procedure Compute is
   begin
      while True loop
         Mix (5_000);
      end loop;
   end Compute;

   procedure Hold_Object is
   begin
      loop
         Shared.Hold (1_500);
      end loop;
   end Hold_Object;

   procedure Wait_And_Hold is
   begin
      delay until Clock + Microseconds (700);
      Shared.Hold (500);
   end Wait_And_Hold;

   procedure Wait_And_Hold_Again is
   begin
      loop
         Wait_And_Hold;
      end loop;
   end Wait_And_Hold_Again;

end Workers;
