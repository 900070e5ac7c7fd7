--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body Counters is

   procedure Count is
   begin
      Value := (Value + 1) mod Limit;
   end Count;

end Counters;
