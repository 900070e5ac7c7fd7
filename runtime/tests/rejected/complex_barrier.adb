--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Simple_Barriers

package body Complex_Barrier is

   protected body Object is
      entry First when Count > 0 is
      begin
         Count := Count - 1;
      end First;
   end Object;

end Complex_Barrier;
