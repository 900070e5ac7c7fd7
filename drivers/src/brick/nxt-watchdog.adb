--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with NXT.Registers.WDT;  use NXT.Registers;

package body NXT.Watchdog is

   function Enabled return Boolean is (not Has (Registers.WDT.WDT.WDT_MR, Registers.WDT.Disabled));

   procedure Restart is
   begin
      Registers.WDT.WDT.WDT_CR := Registers.WDT.Restart;
   end Restart;

end NXT.Watchdog;
