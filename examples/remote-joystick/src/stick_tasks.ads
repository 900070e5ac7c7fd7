--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The display's task. The radio's is in Stick, the co-processor's in NXT.AVR.

with System;

package Stick_Tasks is

   task Display_Task is
      pragma Priority (System.Priority'First + 1);
      pragma Storage_Size (2048);
   end Display_Task;
   --  Every 500 ms: the state on the display; the orange button switches the brick off.

end Stick_Tasks;
