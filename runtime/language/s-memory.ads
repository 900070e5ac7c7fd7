--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  What allocators of access types without a storage pool call. The memory is one block whose
--  size the program states when it is linked, --defsym=ravenbrick_heap_size=<bytes>; a program
--  that allocates without stating it does not link. Blocks are handed out in constant time and
--  never come back: there is nothing to fragment and nothing whose time depends on the past.

package System.Memory is
   pragma Preelaborate;

   type size_t is mod 2 ** Standard'Address_Size;

   function Alloc (Size : size_t) return System.Address
     with Export, Convention => C, External_Name => "__gnat_malloc";
   --  A new block of at least Size bytes, aligned for any type; Storage_Error when the rest of
   --  the memory is smaller

   procedure Free (Block : System.Address)
     with Export, Convention => C, External_Name => "__gnat_free";
   --  No effect

end System.Memory;
