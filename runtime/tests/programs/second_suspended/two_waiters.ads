--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Suspension objects: a flag set in advance lets one pass; a second task may not wait

package Two_Waiters is

   task First_Waiter with Priority => 10, Storage_Size => 512;
   task Second_Waiter with Priority => 9, Storage_Size => 512;

end Two_Waiters;
