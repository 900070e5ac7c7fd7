--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Two tasks on the queue of one entry

package Queue is

   protected Gate with Priority => 20 is
      entry Pass;
   private
      Open : Boolean := False;
   end Gate;

   task One with Priority => 10, Storage_Size => 512;
   task Two with Priority => 9, Storage_Size => 512;

end Queue;
