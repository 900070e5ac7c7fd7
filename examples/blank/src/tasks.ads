--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The tasks of the program. The co-processor task, with the highest priority, is in NXT.AVR.

with System;

package Tasks is

   task Control_Task is
      pragma Priority (System.Priority'First + 2);
      pragma Storage_Size (2048);
   end Control_Task;
   --  Every 20 ms: touch sensor in, motor out.

   task Display_Task is
      pragma Priority (System.Priority'First + 1);
      pragma Storage_Size (4096);
   end Display_Task;
   --  Every 500 ms: how often the sensor was pressed.

end Tasks;
