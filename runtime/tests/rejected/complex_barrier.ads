--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package Complex_Barrier is

   protected Object is
      entry First;
   private
      Count : Integer := 0;
   end Object;

end Complex_Barrier;
