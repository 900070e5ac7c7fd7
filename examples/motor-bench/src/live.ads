--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  What a computer sees of the bench over Bluetooth while it runs, and what it may change:
--  `ravenbrick monitor`.

with Ada.Real_Time;
with NXT.AVR;
with NXT.Telemetry;
with NXT.Telemetry.Bluetooth_Server;
with Speed_Controller;
with System;

package Live with Elaborate_Body is

   use type Ada.Real_Time.Time;
   use NXT.Telemetry;

   Setpoint : constant Parameter := Declare_Parameter ("setpoint", "V", -5.0, 5.0, 4.0);
   --  Of the speed.

   Kp : constant Parameter :=
     Declare_Parameter ("kp", "V/V", 0.0, 2.0, Speed_Controller.Parameters.Proportional_Gain);
   Ki_Ts : constant Parameter :=
     Declare_Parameter
       ("ki_ts", "V/V", 0.0, 0.2, Speed_Controller.Parameters.Integral_Gain_Per_Job);
   --  The controller's gains; at first those of the design.

   procedure Adopt;
   --  The controller works with the gains in force from now on.

   procedure Publish (Wanted, Measured, Control : Float; Angle : Integer);
   --  Volts and degrees.

   function Server_Release return Ada.Real_Time.Time is
     (NXT.AVR.First_Release + Ada.Real_Time.Milliseconds (12));
   --  The display's picture has left by then.

   package Server is new NXT.Telemetry.Bluetooth_Server
     (Program_Name  => "motor-bench",
      Priority      => System.Priority'First,
      Period_Ms     => 20,
      Stack_Bytes   => 768,
      Most_Frames   => 6,
      First_Release => Server_Release);

end Live;
