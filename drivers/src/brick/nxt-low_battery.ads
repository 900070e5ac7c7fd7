--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  When a battery is low. Its voltage is in counts of 13.848 mV, see NXT.Battery.

package NXT.Low_Battery with Preelaborate is

   Low_Pack  : constant ADC_Value := (7_000_000 + 13_847) / 13_848;
   Low_Cells : constant ADC_Value := (6_100_000 + 13_847) / 13_848;
   --  With less the battery is low: 7.0 V of the rechargeable pack, 6.1 V of six cells (chosen; the
   --  picture of the battery begins to blink at 7.1 and 6.1 V in LEGO's firmware 1.29, c_ui.c).

   type Input_Count is mod 2 ** 32;

private

   Empty_Inputs : Input_Count := 0;
   --  Consecutive ones with an empty battery; used by the link's task only

end NXT.Low_Battery;
