--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body Ravenbrick.Accounting is

   procedure Charge is null;

end Ravenbrick.Accounting;
