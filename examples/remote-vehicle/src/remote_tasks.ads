--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The tasks of the vehicle but the radio's, which is in Air, and the co-processor's in NXT.AVR.

with System;

package Remote_Tasks is

   task Control_Task is
      pragma Priority (System.Priority'First + 2);
      pragma Storage_Size (2048);
   end Control_Task;
   --  Every 4 ms: Remote_Driving.Control.

   task Display_Task is
      pragma Priority (System.Priority'First + 1);
      pragma Storage_Size (2048);
   end Display_Task;
   --  Every 500 ms: the state on the display.

end Remote_Tasks;
