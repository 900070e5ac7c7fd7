--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body Alarm_Phases is

   Before_Alarm : constant Time_Span := Microseconds (7);
   Hold_Turns   : constant := 60;
   --  From a reading of the clock until the alarm, and more turns than fit between them

   Shifts : constant := 3;
   --  Of the alarm, by one tick: a turn takes 7 cycles and a tick 16, so that the end of the action
   --  meets the alarm at each second cycle

   Marked : Boolean := False with Volatile;

   protected Object with Priority => Ceiling is
      procedure Hold_Until (At_Time : Time; Turns : Natural);
      --  And some cycles for each turn
   end Object;

   procedure Mark (Turns : Natural) with No_Inline;

   procedure Mark (Turns : Natural) is
   begin
      for Turn in 1 .. Turns loop
         Marked := True;
      end loop;
   end Mark;

   protected body Object is
      procedure Hold_Until (At_Time : Time; Turns : Natural) is
      begin
         while Clock < At_Time loop
            null;
         end loop;
         Mark (Turns);
      end Hold_Until;
   end Object;

   procedure Play_Each is
      Looked, Alarm : Time;
   begin
      for Shift in 1 .. Shifts loop
         for Turns in 1 .. Hold_Turns loop
            Looked := Clock + Microseconds (80) - Before_Alarm;
            Alarm := Looked + Before_Alarm + Shift * Tick;
            Prepare (Alarm);
            Object.Hold_Until (Looked, Turns);
            delay until Alarm + Microseconds (40);
         end loop;
      end loop;
   end Play_Each;

end Alarm_Phases;
