--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Relative delays, which the compiler calls

package System.Relative_Delays is

   procedure Delay_For (D : Duration);
   --  Block the running task for at least D; not above 0: let its equals run first

end System.Relative_Delays;
