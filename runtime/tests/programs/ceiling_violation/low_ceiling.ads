--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A task above the ceiling of the object that it calls

package Low_Ceiling is

   protected Object with Priority => 10 is
      procedure Touch;
   end Object;

   task At_Ceiling with Priority => 10, Storage_Size => 512;
   task Above_Ceiling with Priority => 11, Storage_Size => 512;

end Low_Ceiling;
