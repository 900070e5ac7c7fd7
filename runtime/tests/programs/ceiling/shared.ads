--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A low task releases tasks below, at and above the ceiling of the object it is inside

package Shared is

   task Owner with Priority => 5, Storage_Size => 512;
   task Below with Priority => 10, Storage_Size => 512;
   task Level with Priority => 15, Storage_Size => 512;
   task Above with Priority => 16, Storage_Size => 512;

   protected Object with Priority => 15 is
      procedure Release_All;
   end Object;

end Shared;
