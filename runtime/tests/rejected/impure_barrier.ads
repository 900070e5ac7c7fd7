--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Pure_Barriers: a barrier that calls a function

package Impure_Barrier is

   Limit : Integer := 0;

   protected Object is
      entry First;
   private
      Count : Integer := 0;
   end Object;

end Impure_Barrier;
