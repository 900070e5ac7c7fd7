--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  What must hold at any instant, and the count of its violations

package Checks is

   type Word is mod 2 ** 32;

   type Rule is
     (Exclusive,          --  one caller inside an object at a time
      Consistent,         --  an object's two counts agree when it is entered
      All_Enabled,        --  no interrupt is masked while a task is in no protected action
      Masked_To_Ceiling,  --  inside an object, interrupts up to its ceiling are masked
      Others_Enabled,     --  and those above it are not
      Most_Urgent);       --  no task runs while the server, above all, is released

   type Rule_Counts is array (Rule) of Word with Convention => C;

   Violations : Rule_Counts := (others => 0)
     with Volatile, Export, Convention => C, External_Name => "violations";

   procedure Hold (Subject : Rule; Condition : Boolean) with Inline;

   function Enabled return Word with Inline, Volatile_Function;
   --  Mask register of the interrupt controller (IMR, datasheet 23.9)

   Alarm  : constant Word := 2 ** 12;
   Low    : constant Word := 2 ** 13;
   High   : constant Word := 2 ** 14;

   Server_Is_Due : Boolean := False with Volatile;

end Checks;
