--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package Select_Statement is

   protected Object is
      entry First;
   private
      Open : Boolean := False;
   end Object;

   procedure Try;

end Select_Statement;
