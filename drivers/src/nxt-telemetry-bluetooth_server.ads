--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Telemetry over Bluetooth: whoever knows the code may connect, one at a time; after a lost link
--  the next one. The module belongs to this task.

with System;

generic
   Program_Name : String;
   --  At most 15 letters, shown to the user of the host.

   Pin         : String := "1234";
   Priority    : System.Priority := System.Priority'First;
   Period_Ms   : Positive := 10;
   Stack_Bytes : Positive := 2_048;
package NXT.Telemetry.Bluetooth_Server is

   procedure Require;
   --  Does nothing: calling it keeps the compiler from finding the instance unused.

end NXT.Telemetry.Bluetooth_Server;
