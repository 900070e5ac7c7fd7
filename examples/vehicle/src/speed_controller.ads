--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The controller that design.py generates: generated/functional.h in Ada. The reentrant form is
--  used, since there are two motors: one Work_Area each, tuned by the same parameters.

with Quantities;

package Speed_Controller is

   type External_Inputs is record
      Input_Voltage : Quantities.Volts;
      Real_Voltage  : Quantities.Volts;
   end record with Convention => C;
   --  Set-point and measured speed, both as voltages.

   type External_Outputs is record
      Corrected_Voltage : Quantities.Volts;
   end record with Convention => C;

   type Work_Area is limited record
      Integral : Quantities.Volts;
   end record with Convention => C;

   type Tunable_Parameters is record
      Proportional_Gain     : Float;
      Integral_Gain_Per_Job : Float;
      Tracking_Gain_Per_Job : Float;
      Saturation            : Quantities.Volts;
   end record with Convention => C;
   --  Saturation: the largest voltage that the motors can get. Beyond it the integral stops.

   Parameters : Tunable_Parameters with
     Import, Convention => C, External_Name => "functional_P";

   procedure Initialize (Work : in out Work_Area) with
     Import, Convention => C, External_Name => "functional_initialize_instance";

   procedure Step
     (Work    : in out Work_Area;
      Inputs  : External_Inputs;
      Outputs : out External_Outputs)
   with
     Import, Convention => C, External_Name => "functional_step_instance";
   --  One sample of one controller.

end Speed_Controller;
