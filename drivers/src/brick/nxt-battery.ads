--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The battery, measured by the co-processor.

with Interfaces;

package NXT.Battery is

   type Supply_Millivolts is range 0 .. 15_000;

   function Voltage return Supply_Millivolts;
   --  As in the last frame from the co-processor; 0 as long as there was none.

   function Rechargeable return Boolean;
   --  Whether the rechargeable pack is in, which has a switch of its own.

   function To_Millivolts (Count : ADC_Value) return Supply_Millivolts;

   function Millivolts return Interfaces.Unsigned_32 is (Interfaces.Unsigned_32 (Voltage));
   --  As known from GNAT for MINDSTORMS.

end NXT.Battery;
