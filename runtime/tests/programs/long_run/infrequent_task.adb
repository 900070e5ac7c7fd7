--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;

with Handshake;

package body Infrequent_Task is

   use type Interfaces.Integer_64;

   task body Sleeper is
      Next    : Time := Time_Of (0, Seconds (100));
      Second  : Seconds_Count;
      Part    : Time_Span;
   begin
      delay until Time_Of (0, Milliseconds (500));
      Handshake.Send;
      for Reading of Readings loop
         delay until Next;
         Split (Clock, Second, Part);
         Reading := Interfaces.Integer_64 (Second) * Units_Per_Second
           + Interfaces.Integer_64 (Part / Time_Span_Unit);
         Jobs := Jobs + 1;
         Next := Next + Seconds (100);
      end loop;
      delay until Time_Last;
   end Sleeper;

end Infrequent_Task;
