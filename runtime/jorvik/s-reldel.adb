--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time.Delays;

package body System.Relative_Delays is

   use Ada.Real_Time;

   procedure Delay_For (D : Duration) is
      Now       : constant Time := Clock;
      Remaining : constant Time_Span := To_Time_Span (D);
   begin
      Delays.Delay_Until
        (if Remaining <= Time_Span_Zero then Now
         elsif Remaining < Time_Last - Now then Now + Remaining
         else Time_Last);
   end Delay_For;

end System.Relative_Delays;
