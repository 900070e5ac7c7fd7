--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Quantities of the vehicle, each a type of its own.

package Quantities with Pure is

   type Volts is new Float;

   type Degrees_Per_Second is new Float;

   type Degrees is range -2 ** 31 .. 2 ** 31 - 1;

   --  A motor without load turns with 116 degrees per second per volt, so a speed can be stated as
   --  the voltage that would keep it up. Controllers compare voltages.
   Speed_Per_Volt : constant := 116.0;

   function To_Volts (Speed : Degrees_Per_Second) return Volts is
     (Volts (Speed * (1.0 / Speed_Per_Volt)));

end Quantities;
