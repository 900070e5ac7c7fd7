--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Root of the run-time's own units. Applications use the Ada library above them.

package Ravenbrick is
   pragma Pure;
   pragma No_Elaboration_Code_All;
end Ravenbrick;
