--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Six tasks of different priorities with the same releases

package Six is

   task type Cyclic (Rank : Integer) with Priority => Rank, Storage_Size => 512;

   T1 : Cyclic (16);
   T2 : Cyclic (15);
   T3 : Cyclic (14);
   T4 : Cyclic (13);
   T5 : Cyclic (12);
   T6 : Cyclic (11);

end Six;
