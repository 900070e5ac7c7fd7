--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Three tasks of one priority, which give way to each other by a delay until a time that has
--  passed. A task of a higher priority releases two in one go, and the first of them the third.

package Equals is

   task A with Priority => 10, Storage_Size => 512;
   task B with Priority => 10, Storage_Size => 512;
   task C with Priority => 10, Storage_Size => 512;
   task Releaser with Priority => 20, Storage_Size => 512;

end Equals;
