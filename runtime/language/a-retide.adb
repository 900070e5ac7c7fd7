--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ravenbrick.Delays;
with Ravenbrick.Threads;

package body Ada.Real_Time.Delays is

   function To_Duration (T : Real_Time.Time) return Duration is (To_Duration (Time_Span (T)));

   procedure Delay_Until (T : Time) is
   begin
      if Ravenbrick.Threads.In_Protected_Action (Ravenbrick.Threads.Kernel.Current.Active) then
         raise Program_Error with "delay in a protected action";
      end if;
      Ravenbrick.Delays.Delay_Until (Ravenbrick.Threads.Units (T));
   end Delay_Until;

end Ada.Real_Time.Delays;
