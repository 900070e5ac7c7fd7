--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  No_Terminate_Alternatives and Max_Task_Entries

package body Terminate_Alternative is

   task body Server is
   begin
      loop
         select
            accept Serve;
         or
            terminate;
         end select;
      end loop;
   end Server;

end Terminate_Alternative;
