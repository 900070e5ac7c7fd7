--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;

with Handshake;

package body Release_Lateness is

   task body Seconds_Task is
      Next : Time := Time_Of (1, Time_Span_Zero);
      Late : Long_Long_Integer;
   begin
      delay until Time_Of (0, Milliseconds (500));
      Handshake.Send;
      loop
         delay until Next;
         Late := Long_Long_Integer ((Clock - Next) / Time_Span_Unit);
         Lateness (1) := Long_Long_Integer'Min (Lateness (1), Late);
         Lateness (2) := Long_Long_Integer'Max (Lateness (2), Late);
         Jobs := Jobs + 1;
         Next := Next + Seconds (1);
      end loop;
   end Seconds_Task;

end Release_Lateness;
