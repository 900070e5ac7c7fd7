--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Max_Task_Entries => 0

package Task_Entry is

   task Server with Storage_Size => 512 is
      entry Serve;
   end Server;

end Task_Entry;
