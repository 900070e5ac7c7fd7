--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ravenbrick.Delays;
with Ravenbrick.Threads;

package body Ada.Real_Time.Delays is

   function To_Duration (T : Real_Time.Time) return Duration is (To_Duration (Time_Span (T)));

   procedure Delay_Until (T : Time) is
   begin
      Ravenbrick.Delays.Delay_Until (Ravenbrick.Threads.Units (T));
   end Delay_Until;

end Ada.Real_Time.Delays;
