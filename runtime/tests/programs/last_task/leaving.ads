--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A task without a deadline that ends after 20 ms, and a supervisor that is left alone

package Leaving is

   task Supervisor with Priority => 30, Storage_Size => 1_024;

   task Mortal with Priority => 10, Storage_Size => 1_024;

end Leaving;
