--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Six tasks that are released together, again and again, at instants of random phase; the
--  observer of the threads takes the times

package Six_Tasks is

   Samples : constant := 10_500;

   Finished : Boolean := False
     with Volatile, Export, Convention => C, External_Name => "finished";

   Last_Rank : constant := 11;

   task type Cyclic (Rank : Integer) with Priority => Rank, Storage_Size => 512;

   T1 : Cyclic (16);
   T2 : Cyclic (15);
   T3 : Cyclic (14);
   T4 : Cyclic (13);
   T5 : Cyclic (12);
   T6 : Cyclic (Last_Rank);

end Six_Tasks;
