--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A protected object in a unit of its own, so that its procedure is called, not put in line

package Shared is

   protected Counter with Priority => 20 is
      procedure Add;
   private
      Count : Natural := 0;
   end Counter;

end Shared;
