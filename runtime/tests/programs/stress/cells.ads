--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Protected objects that notice a second caller inside

with System;

with Random_Numbers;

package Cells is

   protected type Cell (Ceiling : System.Any_Priority) is
      pragma Priority (Ceiling);

      procedure Touch (Turns : Random_Numbers.Word; By_Task : Boolean);
      --  Stay for Turns; By_Task: the caller is a task and in no other object

   private
      Occupied : Boolean := False;
      First    : Random_Numbers.Word := 0;
      Second   : Random_Numbers.Word := 0;
   end Cell;

   protected type Outer_Cell
     (Ceiling : System.Any_Priority; Inner : not null access Cell)
   is
      pragma Priority (Ceiling);

      procedure Touch (Turns : Random_Numbers.Word);
      --  Enter Inner, of a higher ceiling, from inside and stay for Turns

   private
      Occupied : Boolean := False;
   end Outer_Cell;

end Cells;
