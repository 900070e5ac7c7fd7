--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Telemetry over Bluetooth: a computer sees the vehicle at each control period, and changes the
--  top speed and the controllers' gains while it drives (`ravenbrick monitor`). The paper has it
--  among its future work.

pragma Restrictions (No_Secondary_Stack);
--  No unit needs one; without it 1.6 KB of memory are free.

with Ada.Real_Time;
with NXT.AVR;
with NXT.Telemetry;
with NXT.Telemetry.Bluetooth_Server;
with System;

package Live with Elaborate_Body is

   use type Ada.Real_Time.Time;
   use NXT.Telemetry;

   type Parameters_functional is record
      Battery, Ki, Kp : Float;
   end record;

   Functional_P : Parameters_functional;
   pragma Import (C, Functional_P, "functional_P");
   --  Of the generated controller; both wheels share them.

   Top_Speed : constant Parameter := Declare_Parameter ("top_speed", "V", 0.0, 9.0, 9.0);
   --  Of both set-points, where the battery allows more.

   Kp : constant Parameter := Declare_Parameter ("kp", "V/V", 0.0, 2.0, Functional_P.Kp);
   Ki : constant Parameter := Declare_Parameter ("ki", "1/s", 0.0, 50.0, Functional_P.Ki);

   procedure Adopt (Battery : Float);
   --  The controllers work with the gains in force, and with this limit in volts, from now on.

   function Server_Release return Ada.Real_Time.Time is
     (NXT.AVR.First_Release + Ada.Real_Time.Milliseconds (12));
   --  The display's picture has left by then.

   package Server is new NXT.Telemetry.Bluetooth_Server
     (Program_Name  => "vehicle",
      Priority      => System.Priority'First + 1,
      Period_Ms     => 20,
      Stack_Bytes   => 1_024,
      Most_Frames   => 6,
      First_Release => Server_Release);
   --  Above the main procedure, which never ends.

end Live;
