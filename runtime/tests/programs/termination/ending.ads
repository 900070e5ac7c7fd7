--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Two tasks that end and one that goes on, with a fall-back handler

package Ending is

   task Short with Priority => 12, Storage_Size => 1024;
   task Later with Priority => 10, Storage_Size => 1024;
   task Endless with Priority => 11, Storage_Size => 768;

end Ending;
