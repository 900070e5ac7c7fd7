--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Max_Protected_Entries => 1

package Two_Entries is

   protected Object is
      entry First;
      entry Second;
   private
      Open : Boolean := False;
   end Object;

end Two_Entries;
