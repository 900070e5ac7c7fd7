--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A slow link whose task is the least urgent one but the main procedure's.

with System;

package NXT.Configuration with Pure is

   Link_Period_Ms : constant := 10;

   Link_Priority : constant System.Priority := System.Priority'First + 1;

end NXT.Configuration;
