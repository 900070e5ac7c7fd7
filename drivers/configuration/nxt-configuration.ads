--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  What an application may set of the drivers: with a copy of this file in a folder of its own,
--  which the project's external variable DRIVERS_CONFIGURATION names by its absolute path.

with System;

package NXT.Configuration with Pure is

   Link_Period_Ms : constant := 2;
   --  The co-processor gets outputs, and gives inputs, every second period. At least 1, so that a
   --  transfer ends within its period; at most 10, so that the link is up 40 ms after the start.

   Link_Priority : constant System.Priority := System.Priority'Last;
   --  Of the task of the link. What runs above it delays motors and sensors; a transfer that is
   --  over is only looked at later.

end NXT.Configuration;
