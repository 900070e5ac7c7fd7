--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Two tasks with deadlines, and what main procedures do beside them, mostly in endless loops

package Workers is
   pragma Elaborate_Body;

   task Control with Priority => 12, Storage_Size => 1_024;
   task Display with Priority => 10, Storage_Size => 1_024;

   procedure Do_Nothing;

   procedure Compute;

   procedure Hold_Object;
   --  Its ceiling is the priority of Control

   procedure Wait_And_Hold;
   --  0.7 ms, so that the alarm is called at all phases of the tasks; returns

   procedure Wait_And_Hold_Again;

end Workers;
