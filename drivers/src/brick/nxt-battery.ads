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

   function Is_Low return Boolean;
   --  Whether Voltage is below 7.0 V of the rechargeable pack or 6.1 V of six cells; False as long
   --  as there was no frame. When this has lasted for 0.8 s, the loudspeaker of a supervised brick
   --  hums for 0.2 s, and so on each second, unless NXT.Audio plays.

   function To_Millivolts (Count : ADC_Value) return Supply_Millivolts;

   function Millivolts return Interfaces.Unsigned_32 is (Interfaces.Unsigned_32 (Voltage));
   --  As known from GNAT for MINDSTORMS.

end NXT.Battery;
