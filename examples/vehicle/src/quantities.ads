--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Quantities of the vehicle, each a type of its own.

with Controller_Design;

package Quantities with Pure is

   type Volts is new Float;

   type Degrees_Per_Second is new Float;

   type Degrees is range -2 ** 31 .. 2 ** 31 - 1;

   function To_Volts (Speed : Degrees_Per_Second) return Volts is
     (Volts (Speed * (1.0 / Controller_Design.Speed_Per_Volt)));
   --  The voltage that would keep up a speed without load. Controllers compare voltages.

end Quantities;
