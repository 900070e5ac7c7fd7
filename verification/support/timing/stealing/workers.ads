--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A task that sends all of the memory again and again, by transfers that no interrupt announces,
--  and one that computes meanwhile.

package Workers is
   pragma Elaborate_Body;

   task Mover with Priority => 12, Storage_Size => 1_024;
   task Computation with Priority => 10, Storage_Size => 1_024;

end Workers;
