--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time; use Ada.Real_Time;

with Journal; use Journal;
with Ravenbrick.Supervision;

package body Leaving is

   task body Supervisor is
      Step_Ms : constant := 2;
      Next    : Time     := Clock;
   begin
      loop
         Next := Next + Milliseconds (Step_Ms);
         delay until Next;
         Ravenbrick.Supervision.Check (Step_Ms);
      end loop;
   end Supervisor;

   task body Mortal is
   begin
      delay until Clock + Milliseconds (20);
      Note ('e');
   end Mortal;

end Leaving;
