--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Work for jobs, of a time that depends on nothing but its rounds

package Mixing is

   procedure Mix (Rounds : Positive) with No_Inline;

end Mixing;
