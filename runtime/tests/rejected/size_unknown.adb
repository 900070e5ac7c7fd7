--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body Size_Unknown is

   task body Sizeless is
   begin
      loop
         null;
      end loop;
   end Sizeless;

end Size_Unknown;
