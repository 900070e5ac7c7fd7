--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Four tasks, two interrupt handlers and the alarm share nine objects at random instants

with System; use System;

with Random_Numbers; use Random_Numbers;

package Contenders is

   type Totals is array (1 .. 6) of Word with Convention => C;

   Touched : Totals := (others => 0)
     with Volatile, Export, Convention => C, External_Name => "touched";
   --  Actions of workers 1 to 4, of the low handler and of the high handler

   Requests : Word := 0
     with Volatile, Export, Convention => C, External_Name => "requests";
   Served : Word := 0
     with Volatile, Export, Convention => C, External_Name => "served";
   --  Releases of the server by the high handler, and its jobs

   task type Worker (Number : Word; Level : System.Priority)
     with Priority => Level, Storage_Size => 1024;

   Worker_1 : Worker (1, 5);
   Worker_2 : Worker (2, 8);
   Worker_3 : Worker (3, 8);
   Worker_4 : Worker (4, 14);

   task Server with Priority => 20, Storage_Size => 1024;

end Contenders;
