--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The battery, measured by the co-processor.

package NXT.Battery is

   function Voltage return Millivolts;
   --  As in the last frame from the co-processor; 0 as long as there was none.

   function Rechargeable return Boolean;
   --  Whether the rechargeable pack is in, which has a switch of its own.

   function To_Millivolts (Count : ADC_Value) return Millivolts;

end NXT.Battery;
