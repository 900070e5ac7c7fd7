--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Telemetry over USB: a host that takes the brick's two bulk endpoints for a stream of bytes.
--  The port belongs to this task. A program has one server, over Bluetooth or over USB.

with Ada.Real_Time;
with NXT.Bytes;
with NXT.Telemetry.Server;
with NXT.USB;
with System;

generic
   Program_Name : String;
   --  At most 15 letters, shown to the user of the host.

   Serial      : NXT.USB.Serial_Text := "001653000000";
   Priority    : System.Priority := System.Priority'First;
   Period_Ms   : Positive := 5;
   Stack_Bytes : Positive := 2_048;
   Most_Frames : Positive := 12;
   --  Most_Frames: that are sent in a period; what is left waits for the next one.

   with function First_Release return Ada.Real_Time.Time is Ada.Real_Time.Clock;
   --  Jobs are released whole periods after it.
package NXT.Telemetry.USB_Server is

   procedure Require;
   --  Does nothing: calling it keeps the compiler from finding the instance unused.

private

   procedure Start;
   function Room return Natural;
   procedure Send (Data : Bytes.Byte_Array);
   procedure Receive (Data : out Bytes.Byte_Array; Last : out Natural);

   package Link_Server is new NXT.Telemetry.Server
     (Program_Name  => Program_Name,
      Start         => Start,
      Room          => Room,
      Send          => Send,
      Receive       => Receive,
      Priority      => Priority,
      Period_Ms     => Period_Ms,
      Stack_Bytes   => Stack_Bytes,
      Most_Frames   => Most_Frames,
      First_Release => First_Release);

end NXT.Telemetry.USB_Server;
