--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Delays until a calendar date, which the compiler calls

package Ada.Calendar.Delays is

   procedure Delay_For (D : Duration);
   --  Block the running task for at least D

   procedure Delay_Until (T : Time);
   --  Block the running task until T

   function To_Duration (T : Time) return Duration;
   --  From the start of the clock of Ada.Real_Time to T

end Ada.Calendar.Delays;
