--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Pure_Barriers: a barrier that calls a function

package body Impure_Barrier is

   function Is_Open (Count : Integer) return Boolean is (Count > Limit);

   protected body Object is
      entry First when Is_Open (Count) is
      begin
         Count := Count - 1;
      end First;
   end Object;

end Impure_Barrier;
