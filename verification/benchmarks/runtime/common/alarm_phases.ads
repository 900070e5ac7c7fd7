--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The end of a protected action that meets an alarm at each phase

with Ada.Real_Time; use Ada.Real_Time;
with System;

with Timers;

package Alarm_Phases is

   Ceiling : constant System.Priority := 20;
   --  Of the protected action

   Whole_Count : constant Time_Span := (Tick * 2 ** 30) * 4;
   --  Until the clock's count of ticks begins again

   Soon : constant Timers.Word := 100;
   --  In counts of two cycles: while the action that started the timer lasts

   generic
      with procedure Prepare (Alarm : Time);
      --  Sets the alarm, and starts what is to become ready in the action before it
   procedure Play_Each;

end Alarm_Phases;
