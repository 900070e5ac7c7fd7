--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The two-wire bus to the co-processor.

package Link_Timing is

   procedure Await_Quiet;
   --  Until the transfer of this period has ended, and at least half a millisecond is left until
   --  the next one begins.

   procedure Measure;
   --  Durations of transfers in both directions, pauses between them, and errors.

end Link_Timing;
