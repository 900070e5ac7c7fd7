--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  No_Task_Allocators

package Allocated_Task is

   task type Worker with Storage_Size => 512;

   type Worker_Access is access Worker;

   First : Worker_Access := new Worker;

end Allocated_Task;
