--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.AVR;
with NXT.AVR_IO;
with NXT.Low_Battery;

package body NXT.Battery is

   --  The converter sees the battery over a divider of 22 and 12 kilohms with a reference of 5 V:
   --  5000 mV / 1023 * 34 / 12 = 13.848 mV per count.
   Numerator   : constant := 13_848;
   Denominator : constant := 1_000;

   function To_Millivolts (Count : ADC_Value) return Supply_Millivolts is
     (Supply_Millivolts (Integer (Count) * Numerator / Denominator));

   function Voltage return Supply_Millivolts is (To_Millivolts (NXT.AVR.Inputs.Battery_Count));

   function Rechargeable return Boolean is (NXT.AVR.Inputs.Rechargeable);

   function Is_Low return Boolean is
      Values : constant AVR_IO.Inputs := NXT.AVR.Inputs;
      Good   : constant ADC_Value :=
        (if Values.Rechargeable then Low_Battery.Low_Pack else Low_Battery.Low_Cells);
   begin
      return Values.Battery_Count in 1 .. Good - 1;
   end Is_Low;

end NXT.Battery;
