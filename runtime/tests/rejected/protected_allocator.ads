--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  No_Protected_Type_Allocators

package Protected_Allocator is

   protected type Object is
      procedure Change;
   end Object;

   type Object_Access is access Object;

   First : Object_Access := new Object;

end Protected_Allocator;
