--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A task that executes direct commands over Bluetooth: each telegram has its length before it, two
--  bytes, the lower one first. Whoever knows the code may connect.

with System;

generic
   Program_Name : String;
   --  At most 15 letters: the brick's name for the host.

   Pin         : String := "1234";
   Priority    : System.Priority := System.Priority'First;
   Period_Ms   : Positive := 5;
   Stack_Bytes : Positive := 2_048;
package NXT.Direct_Commands.Bluetooth_Server is

   procedure Require;
   --  Does nothing: calling it keeps the compiler from finding the instance unused.

end NXT.Direct_Commands.Bluetooth_Server;
