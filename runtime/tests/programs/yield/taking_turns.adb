--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Dispatching;

with Journal;

package body Taking_Turns is

   task body Player is
   begin
      for Turn in 1 .. 10 loop
         Journal.Note (Mark);
         Ada.Dispatching.Yield;
      end loop;
   end Player;

end Taking_Turns;
