--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The controller that design.py generates: generated/functional.h in Ada, for its one instance.

package Speed_Controller is

   type External_Inputs is record
      Input_Voltage : Float := 0.0;
      Real_Voltage  : Float := 0.0;
   end record with Convention => C;
   --  Set-point and measured speed, both as voltages.

   type External_Outputs is record
      Corrected_Voltage : Float := 0.0;
   end record with Convention => C;

   type Tunable_Parameters is record
      Proportional_Gain     : Float;
      Integral_Gain_Per_Job : Float;
      Tracking_Gain_Per_Job : Float;
      Saturation            : Float;
   end record with Convention => C;
   --  Saturation: the largest voltage that the motor can get.

   Inputs     : External_Inputs with Export, Convention => C, External_Name => "functional_U";
   Outputs    : External_Outputs with Export, Convention => C, External_Name => "functional_Y";
   Parameters : Tunable_Parameters with
     Import, Convention => C, External_Name => "functional_P";

   procedure Initialize with
     Import, Convention => C, External_Name => "functional_initialize";

   procedure Step with
     Import, Convention => C, External_Name => "functional_step";
   --  One sample.

end Speed_Controller;
