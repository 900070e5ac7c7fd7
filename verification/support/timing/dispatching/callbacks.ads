--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package Callbacks is

   type Action is access procedure (Steps : Positive);

   type Table is limited record
      Call : Action;
   end record;

   type Any_Table is access all Table;

   type Holder is limited record
      Now : Any_Table;
   end record;

end Callbacks;
