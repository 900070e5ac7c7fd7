--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A task that executes direct commands over USB: each packet is a telegram.

with System;

generic
   Program_Name : String;
   --  At most 15 letters: the brick's name for the host.

   Priority    : System.Priority := System.Priority'First;
   Period_Ms   : Positive := 5;
   Stack_Bytes : Positive := 2_048;
package NXT.Direct_Commands.USB_Server is

   procedure Require;
   --  Does nothing: calling it keeps the compiler from finding the instance unused.

end NXT.Direct_Commands.USB_Server;
