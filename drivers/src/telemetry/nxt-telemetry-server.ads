--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The task that talks to a host over a byte link. It never waits for the link: it gives it what
--  there is room for and comes again. Without a word from the host for three seconds it is quiet.

with Ada.Real_Time;
with NXT.Bytes;
with System;

generic
   Program_Name : String;
   --  At most 15 letters, shown to the user of the host.

   with procedure Start;
   --  Called once by the task, before anything else. May wait.

   with procedure Attend is null;
   --  Called once in each job, before anything else.

   with function Room return Natural;
   --  How many bytes Send takes now without waiting.

   with procedure Send (Data : Bytes.Byte_Array);
   --  Hand over at most Room bytes.

   with procedure Receive (Data : out Bytes.Byte_Array; Last : out Natural);
   --  What has arrived, at most Data'Length bytes, in Data (Data'First .. Last).

   Priority    : System.Priority := System.Priority'First;
   Period_Ms   : Positive := 10;
   Stack_Bytes : Positive := 2_048;

   Most_Frames : Positive := 12;
   --  That a job sends; what is left waits for the next. It bounds the job's execution time.

   with function First_Release return Ada.Real_Time.Time is Ada.Real_Time.Clock;
   --  Called once by the task, after Start. Jobs are released whole periods after it, the first at
   --  least a period later than the call.
package NXT.Telemetry.Server is

   procedure Require;
   --  Does nothing: calling it keeps the compiler from finding the instance unused.

end NXT.Telemetry.Server;
