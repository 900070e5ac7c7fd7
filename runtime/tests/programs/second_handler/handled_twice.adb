--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body Handled_Twice is

   protected body Source is
      procedure Handle is null;
   end Source;

end Handled_Twice;
