--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Three tasks of one priority that a task of a higher priority releases in one go, and that
--  give way to each other by a delay until a time that has passed

package Equals is

   task A with Priority => 10, Storage_Size => 512;
   task B with Priority => 10, Storage_Size => 512;
   task C with Priority => 10, Storage_Size => 512;
   task Releaser with Priority => 20, Storage_Size => 512;

end Equals;
