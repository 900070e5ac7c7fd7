--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Listing 1 of the paper. The co-processor task, with the highest priority, is in NXT.AVR.

with System;

package Tasks is

   task Control_Task is
      pragma Priority (System.Priority'First + 2);
      pragma Storage_Size (4096);
   end Control_Task;

   task Display_Task is
      pragma Priority (System.Priority'First + 1);
      pragma Storage_Size (4096);
   end Display_Task;

end Tasks;
