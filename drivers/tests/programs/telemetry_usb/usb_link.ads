--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  What the test program declares, and its server over USB.

with NXT.Telemetry;
with NXT.Telemetry.USB_Server;

package USB_Link with Elaborate_Body is

   Ki : constant NXT.Telemetry.Parameter :=
     NXT.Telemetry.Declare_Parameter ("ki", "1/s", 0.0, 50.0, 8.0);

   package Server is new NXT.Telemetry.USB_Server
     (Program_Name => "usb test", Serial => "00165300ABCD");

end USB_Link;
