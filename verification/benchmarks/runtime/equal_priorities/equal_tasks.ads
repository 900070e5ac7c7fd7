--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Sixteen tasks that delay themselves one after the other until the same time, each behind all
--  that came before it: how critical sections grow with the number of tasks

package Equal_Tasks is

   task type Equal with Priority => 10, Storage_Size => 384;

   All_Equal : array (1 .. 16) of Equal;

end Equal_Tasks;
