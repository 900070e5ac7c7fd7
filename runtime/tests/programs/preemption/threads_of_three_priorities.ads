--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The low task releases the middle and the high one; each notes when it starts and ends

package Threads_Of_Three_Priorities is

   procedure Start;

   task Low with Priority => 10, Storage_Size => 512;
   task Middle with Priority => 11, Storage_Size => 512;
   task High with Priority => 12, Storage_Size => 512;

end Threads_Of_Three_Priorities;
