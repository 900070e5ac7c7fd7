--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with System.Relative_Delays;

with Ada.Real_Time.Delays;

package body Ada.Calendar.Delays is

   procedure Delay_For (D : Duration) renames System.Relative_Delays.Delay_For;

   procedure Delay_Until (T : Time) is
   begin
      Real_Time.Delays.Delay_Until
        (Real_Time.Time_Of (0, Real_Time.To_Time_Span (To_Duration (T))));
   end Delay_Until;

   function To_Duration (T : Time) return Duration is (From_Start (T));

end Ada.Calendar.Delays;
