--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Three tasks of one priority, each of which gives way after each mark

package Taking_Turns is

   task type Player (Mark : Character) with Priority => 10, Storage_Size => 512;

   A : Player ('a');
   B : Player ('b');
   C : Player ('c');

end Taking_Turns;
