--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The alarm: channel 0 of the timer counter in one-shot mode. It counts MCK/1024 while the
--  wake-up time is far and MCK/2 for the last stretch, so it may ring before the time it was
--  set to, never more than 1.4 s after the latest setting.

with Ravenbrick.Threads;

package Ravenbrick.Alarm is
   pragma Preelaborate;

   procedure Initialize;
   --  Clock the channel and let its compare event request the interrupt

   subtype Fine_Count is Positive range 1 .. 100;

   procedure Set (Remaining : Threads.Units; Spent : Fine_Count)
     with Inline,
          Pre => Threads.Interrupts_Masked;
   --  Ring after Remaining or some time before. Spent times 2 cycles have surely passed since the
   --  reading of the clock that Remaining was computed from.

   procedure Acknowledge with Inline;
   --  Withdraw the request

end Ravenbrick.Alarm;
