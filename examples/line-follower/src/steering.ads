--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The controller that design.py generates: generated/functional.h in Ada.

package Steering is

   type External_Inputs is record
      Wanted_Brightness : Float := 0.0;
      Brightness        : Float := 0.0;
   end record with Convention => C;
   --  0 on black, 1 on white.

   Inputs : External_Inputs with Export, Convention => C, External_Name => "functional_U";

   Output : Float := 0.0 with Export, Convention => C, External_Name => "functional_Y";
   --  Volts; half of it is added to the right wheel and taken from the left one.

   procedure Initialize with
     Import, Convention => C, External_Name => "functional_initialize";

   procedure Step with
     Import, Convention => C, External_Name => "functional_step";
   --  One sample.

end Steering;
