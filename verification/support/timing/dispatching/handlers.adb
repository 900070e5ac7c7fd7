--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body Handlers is

   protected body Box is
      procedure Fire is
      begin
         Count := (Count + 1) mod 9;
      end Fire;
   end Box;

end Handlers;
