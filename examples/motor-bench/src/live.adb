--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body Live is

   procedure Adopt is
   begin
      Speed_Controller.Parameters.Proportional_Gain := Current (Kp);
      Speed_Controller.Parameters.Integral_Gain_Per_Job := Current (Ki_Ts);
   end Adopt;

   procedure Publish (Wanted, Measured, Control : Float; Angle : Integer) is
   begin
      NXT.Telemetry.Publish
        (1, (Of_Real (Wanted), Of_Real (Measured), Of_Real (Control), Of_Whole (Angle)));
   end Publish;

begin
   Declare_Signal (1, "setpoint", "V", Real);
   Declare_Signal (1, "speed", "V", Real);
   Declare_Signal (1, "control", "V", Real);
   Declare_Signal (1, "angle", "deg", Whole);
end Live;
