--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A generic unit: its object has no code, and no debug information

generic
   Limit : Positive;
package Counters is

   procedure Count;

   Value : Natural := 0;

end Counters;
