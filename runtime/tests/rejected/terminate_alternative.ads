--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  No_Terminate_Alternatives and Max_Task_Entries

package Terminate_Alternative is

   task Server with Storage_Size => 512 is
      entry Serve;
   end Server;

end Terminate_Alternative;
