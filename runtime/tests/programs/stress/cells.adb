--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Checks; use Checks;

package body Cells is

   use System;
   use type Random_Numbers.Word;

   function Up_To (Ceiling : Any_Priority) return Checks.Word is
     ((if Ceiling >= Interrupt_Priority'First then Alarm else 0)
      or (if Ceiling >= Interrupt_Priority'First + 2 then Low else 0)
      or (if Ceiling >= Interrupt_Priority'First + 5 then High else 0));

   protected body Cell is

      procedure Touch (Turns : Random_Numbers.Word; By_Task : Boolean) is
      begin
         Hold (Exclusive, not Occupied);
         Hold (Consistent, First = Second);
         Occupied := True;
         First := First + 1;
         if By_Task then
            Hold (Masked_To_Ceiling, (Enabled and Up_To (Ceiling)) = 0);
            Hold (Others_Enabled, (Enabled or Up_To (Ceiling)) = (Alarm or Low or High));
         end if;
         Random_Numbers.Spend (Turns);
         Second := Second + 1;
         Occupied := False;
      end Touch;

   end Cell;

   protected body Outer_Cell is

      procedure Touch (Turns : Random_Numbers.Word) is
      begin
         Hold (Exclusive, not Occupied);
         Occupied := True;
         Inner.Touch (Turns, By_Task => False);
         Hold (Masked_To_Ceiling, (Enabled and Up_To (Ceiling)) = 0);
         Random_Numbers.Spend (Turns);
         Occupied := False;
      end Touch;

   end Outer_Cell;

end Cells;
