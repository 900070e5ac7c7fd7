--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Telemetry over Bluetooth: whoever knows the code may connect, one at a time; after a lost link
--  the next one. The module belongs to this task.

with NXT.Bluetooth;
with NXT.Bytes;
with NXT.Telemetry.Server;
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

private

   procedure Start;
   procedure Receive (Data : out Bytes.Byte_Array; Last : out Natural);

   package Talk is new NXT.Telemetry.Server
     (Program_Name => Program_Name,
      Start        => Start,
      Room         => Bluetooth.Room,
      Send         => Bluetooth.Send,
      Receive      => Receive,
      Priority     => Priority,
      Period_Ms    => Period_Ms,
      Stack_Bytes  => Stack_Bytes);

end NXT.Telemetry.Bluetooth_Server;
