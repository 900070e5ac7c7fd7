--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A heap of no bytes, for programs with functions that make objects of limited types: the compiler
--  refers to the heap there and never uses it. Such a program names this package in a context
--  clause, as with GNAT GPL for MINDSTORMS. A program that does allocate is linked with a heap
--  instead: see System.Memory of the run-time.

with Interfaces;
with System;

package NXT.Malloc is

   function Refuse (Bytes : Interfaces.Unsigned_32) return System.Address
     with Export, Convention => C, External_Name => "__gnat_malloc";
   --  Storage_Error.

end NXT.Malloc;
