--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A task without Storage_Size: its stack would have to come from a heap

package Size_Unknown is

   task Sizeless;

end Size_Unknown;
