--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.Priorities;

package Commanding is

   task Suspended_Task with Priority => 2, Storage_Size => 1024;

   task Driving_Task with Priority => NXT.Priorities.Regulator_Task, Storage_Size => 2048;
   --  Drives motor B every 2 ms, and counts presses.

end Commanding;
