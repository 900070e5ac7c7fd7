--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Pragma Task_Info has no effect on this target; the compiler passes the value on

package System.Task_Info is
   pragma Pure;

   type Task_Info_Type is (Unspecified_Task_Info);

end System.Task_Info;
