--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Calendar; use Ada.Calendar;
with Journal;

package body Many_Entries is

   protected body Gate is

      procedure Open (Count : Natural) is
      begin
         Passes := Passes + Count;
         No_More := Pass'Count <= Passes;
      end Open;

      entry Pass (Mark : Character) when Passes > 0 is
      begin
         Passes := Passes - 1;
         Journal.Note (Mark);
      end Pass;

      entry Left_Over when No_More is
      begin
         Journal.Note ('l');
      end Left_Over;

      function Waiting return Natural is (Passes);

   end Gate;

   procedure Join (After : Duration; Mark : Character);
   --  Wait for the gate, After the start

   procedure Join (After : Duration; Mark : Character) is
      Start : constant Time := Clock;
   begin
      delay After;
      if Clock - Start < After then
         Journal.Note ('!');
      end if;
      Gate.Pass (Mark);
   end Join;

   task body First is
   begin
      Join (0.001, '1');
      delay until Time_Of (2000, 1, 1, 0.060);
      Journal.Note ('c');
      loop
         delay 1.0;
      end loop;
   end First;

   task body Second is
   begin
      Join (0.002, '2');
      loop
         delay 1.0;
      end loop;
   end Second;

   task body Third is
   begin
      Join (0.003, '3');
      loop
         delay 1.0;
      end loop;
   end Third;

   task body Last is
   begin
      Gate.Left_Over;
      loop
         delay 1.0;
      end loop;
   end Last;

end Many_Entries;
