--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Telemetry over Bluetooth: whoever knows the code may connect, one at a time; after a lost link
--  the next one. The module belongs to this task.

with Ada.Real_Time;
with NXT.Bluetooth;
with NXT.Telemetry.Server;
with System;

generic
   Program_Name : String;
   --  At most 15 letters, shown to the user of the host.

   Pin         : String := "1234";
   Priority    : System.Priority := System.Priority'First;
   Period_Ms   : Positive := 10;
   Stack_Bytes : Positive := 2_048;
   Most_Frames : Positive := 12;
   --  Most_Frames: that are sent in a period; what is left waits for the next one.

   with function First_Release return Ada.Real_Time.Time is Ada.Real_Time.Clock;
   --  Jobs are released whole periods after it.
package NXT.Telemetry.Bluetooth_Server is

   procedure Require;
   --  Does nothing: calling it keeps the compiler from finding the instance unused.

private

   procedure Start with No_Inline;
   --  Its waits are none of the server's own.

   package Link_Server is new NXT.Telemetry.Server
     (Program_Name  => Program_Name,
      Start         => Start,
      Attend        => Bluetooth.Poll,
      Room          => Bluetooth.Room,
      Send          => Bluetooth.Send,
      Receive       => Bluetooth.Receive,
      Priority      => Priority,
      Period_Ms     => Period_Ms,
      Stack_Bytes   => Stack_Bytes,
      Most_Frames   => Most_Frames,
      First_Release => First_Release);

end NXT.Telemetry.Bluetooth_Server;
