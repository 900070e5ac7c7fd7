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

   procedure Set (Wake : Threads.Units) with Inline;
   --  Ring at Wake or some time before it; interrupts are masked

   procedure Acknowledge with Inline;
   --  Withdraw the request

end Ravenbrick.Alarm;
