--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body USB_Link is

   use NXT.Telemetry;

begin
   Declare_Signal (1, "count", "", Whole);
   for Number in 2 .. 8 loop
      Declare_Signal (1, "gain" & Character'Val (Character'Pos ('0') + Number), "1/s", Real);
   end loop;
end USB_Link;
