--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The tasks of the bench. The co-processor task, with the highest priority, is in NXT.AVR.

with System;

package Tasks is

   task Control_Task is
      pragma Priority (System.Priority'First + 2);
      pragma Storage_Size (768);
   end Control_Task;
   --  Every 4 ms: Bench.Control.

   task Display_Task is
      pragma Priority (System.Priority'First + 1);
      pragma Storage_Size (768);
   end Display_Task;
   --  Every 500 ms: the state on the display.

end Tasks;
