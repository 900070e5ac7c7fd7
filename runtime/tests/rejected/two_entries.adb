--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Max_Protected_Entries => 1

package body Two_Entries is

   protected body Object is

      entry First when Open is
      begin
         Open := False;
      end First;

      entry Second when not Open is
      begin
         Open := True;
      end Second;

   end Object;

end Two_Entries;
