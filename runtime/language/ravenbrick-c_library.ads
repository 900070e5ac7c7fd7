--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The functions of the C library that units of the compiler and the mathematical library call

with Interfaces.C;
with System;

package Ravenbrick.C_Library is
   pragma Preelaborate;

   function String_Length (Text : System.Address) return Interfaces.C.size_t
     with Export, Convention => C, External_Name => "strlen";
   --  Characters before the first NUL

   function Error_Number return System.Address
     with Export, Convention => C, External_Name => "__errno";
   --  Where mathematical functions note an argument outside their domain. Nobody reads it: the
   --  Ada functions above them check their arguments.

end Ravenbrick.C_Library;
