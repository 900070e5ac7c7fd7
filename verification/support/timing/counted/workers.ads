--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with System;

package Workers is

   pragma Elaborate_Body;

   task Control with Priority => System.Priority'First + 12, Storage_Size => 2048;
   task Listener with Priority => System.Priority'First + 11, Storage_Size => 1024;

end Workers;
