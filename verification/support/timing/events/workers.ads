--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Tasks between timing events: a heartbeat that sets itself again, and a timeout that each job of
--  Control sets, which lets Server go on.

package Workers is
   pragma Elaborate_Body;

   task Control with Priority => 12, Storage_Size => 1_024;
   task Server with Priority => 11, Storage_Size => 1_024;
   task Display with Priority => 10, Storage_Size => 1_024;

end Workers;
