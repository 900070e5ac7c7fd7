--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The controller that design.py generates: generated/functional.h in Ada.

package State_Feedback is

   type External_Inputs is record
      Wheel_Angle : Float := 0.0;
      Pitch_Rate  : Float := 0.0;
   end record with Convention => C;
   --  Radians, mean of both wheels against the body; radians per second.

   type External_Outputs is record
      Motor_Voltage : Float := 0.0;
      Body_Pitch    : Float := 0.0;
   end record with Convention => C;

   Inputs  : External_Inputs with Export, Convention => C, External_Name => "functional_U";
   Outputs : External_Outputs with Export, Convention => C, External_Name => "functional_Y";

   Saturation : Float with Import, Convention => C, External_Name => "functional_P";
   --  First of the tunable parameters: the largest voltage that the motors can get.

   procedure Initialize with
     Import, Convention => C, External_Name => "functional_initialize";

   procedure Step with
     Import, Convention => C, External_Name => "functional_step";
   --  One sample.

end State_Feedback;
