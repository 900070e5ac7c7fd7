--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body Shared is

   protected body Counter is
      procedure Add is
      begin
         Count := Count + 1;
      end Add;
   end Counter;

end Shared;
