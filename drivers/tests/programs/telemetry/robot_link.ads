--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  What the test program declares, and its server over Bluetooth.

with NXT.Telemetry;
with NXT.Telemetry.Bluetooth_Server;

package Robot_Link with Elaborate_Body is

   Kp : constant NXT.Telemetry.Parameter :=
     NXT.Telemetry.Declare_Parameter ("kp", "", 0.0, 2.0, 0.5);
   Ki : constant NXT.Telemetry.Parameter :=
     NXT.Telemetry.Declare_Parameter ("ki", "1/s", 0.0, 50.0, 8.0);

   package Server is new NXT.Telemetry.Bluetooth_Server (Program_Name => "test", Pin => "1234");

end Robot_Link;
