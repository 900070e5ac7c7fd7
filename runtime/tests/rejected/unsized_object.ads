--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A protected object of a size that is not known before the program runs

package Unsized_Object is

   protected type Buffer (Length : Positive) is
      procedure Clear;
   private
      Text : String (1 .. Length);
   end Buffer;

   Wanted : Positive := 5 with Volatile;

   Shared : Buffer (Wanted);

end Unsized_Object;
