--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Groups of one, four and eight signals, a parameter, and the server over Bluetooth.

with NXT.Telemetry;
with NXT.Telemetry.Bluetooth_Server;

package Cost_Link with Elaborate_Body is

   Gain : constant NXT.Telemetry.Parameter :=
     NXT.Telemetry.Declare_Parameter ("gain", "", 0.0, 2.0, 0.5);

   package Server is new NXT.Telemetry.Bluetooth_Server (Program_Name => "costs");

end Cost_Link;
