--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.Direct_Commands.Bluetooth_Server;

package Host_Link is

   package Server is new NXT.Direct_Commands.Bluetooth_Server (Program_Name => "Ravenbrick");

end Host_Link;
