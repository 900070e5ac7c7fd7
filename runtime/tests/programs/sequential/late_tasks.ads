--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

pragma Partition_Elaboration_Policy (Sequential);

--  Tasks that start only after the elaboration of the whole partition

package Late_Tasks is

   procedure Note_Main;

   task One with Priority => 10, Storage_Size => 512;
   task Two with Priority => 11, Storage_Size => 512;

end Late_Tasks;
