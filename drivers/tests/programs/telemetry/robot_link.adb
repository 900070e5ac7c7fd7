--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body Robot_Link is

   use NXT.Telemetry;

begin
   Declare_Signal (1, "setpoint", "V", Real);
   Declare_Signal (1, "count", "", Whole);
   Declare_Signal (1, "odd", "", Truth);
   Declare_Signal (2, "slow", "m", Real);
end Robot_Link;
