--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The two-wire bus of a sensor port against a peripheral that follows a script, tick by tick.

package NXT.Bus_Log is

   procedure Run_Scenarios;

end NXT.Bus_Log;
