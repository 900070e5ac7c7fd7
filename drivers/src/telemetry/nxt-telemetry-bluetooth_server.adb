--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Real_Time;  use Ada.Real_Time;

package body NXT.Telemetry.Bluetooth_Server is

   Retry_Period : constant Time_Span := Seconds (1);

   --  The module is asked until it answers.
   procedure Start is
   begin
      loop
         pragma Annotate (Ravenbrick, Iterations, 600, "ten minutes, before the first job");
         Bluetooth.Initialize;
         exit when Bluetooth.Available;
         delay until Clock + Retry_Period;
      end loop;
      Bluetooth.Set_Discoverable (True);
      Bluetooth.Serve (Bluetooth.To_Pin (Pin));
      delay until Clock + Milliseconds (4);  --  Between two waits the task does one thing only.
   end Start;

   procedure Require is
   begin
      Link_Server.Require;
   end Require;

end NXT.Telemetry.Bluetooth_Server;
