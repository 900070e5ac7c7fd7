--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body Ravenbrick.Accounting is

   procedure Charge_Current
     with Import, Convention => C, External_Name => "ravenbrick_charge_execution_time";

   procedure Charge is
   begin
      Charge_Current;
   end Charge;

end Ravenbrick.Accounting;
