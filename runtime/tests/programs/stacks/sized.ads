--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Tasks of several sizes, of a type and alone; one that ends

package Sized is

   task Small with Priority => 10, Storage_Size => 400;
   task Large with Priority => 11, Storage_Size => 3_000;
   task Ending with Priority => 13, Storage_Size => 512;

   task type Typed (Rank : Integer) with Priority => Rank, Storage_Size => 600;

   First_Typed  : Typed (3);
   Second_Typed : Typed (4);

end Sized;
