--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  The pool of an access type with a Storage_Size: one block, from which objects are taken in
--  constant time. Objects of one known size are taken again after they have been deallocated.

with System.Storage_Elements;
with System.Storage_Pools;

package System.Pool_Size is
   pragma Preelaborate;

   package SSE renames System.Storage_Elements;

   type Stack_Bounded_Pool
     (Pool_Size : SSE.Storage_Count;
      Elmt_Size : SSE.Storage_Count;
      Alignment : SSE.Storage_Count)
   is new System.Storage_Pools.Root_Storage_Pool with private;
   --  Pool_Size bytes for objects of Elmt_Size bytes each, 0: of any size

   overriding procedure Allocate
     (Pool         : in out Stack_Bounded_Pool;
      Address      : out System.Address;
      Storage_Size : SSE.Storage_Count;
      Alignment    : SSE.Storage_Count);
   --  Storage_Error when the rest of the block is too small

   overriding procedure Deallocate
     (Pool         : in out Stack_Bounded_Pool;
      Address      : System.Address;
      Storage_Size : SSE.Storage_Count;
      Alignment    : SSE.Storage_Count);

   overriding function Storage_Size (Pool : Stack_Bounded_Pool) return SSE.Storage_Count is
     (Pool.Pool_Size);

private

   type Memory is array (SSE.Storage_Offset range <>) of aliased SSE.Storage_Element
     with Alignment => 8;

   type Stack_Bounded_Pool
     (Pool_Size : SSE.Storage_Count;
      Elmt_Size : SSE.Storage_Count;
      Alignment : SSE.Storage_Count)
   is new System.Storage_Pools.Root_Storage_Pool with record
      Used  : SSE.Storage_Count := 0;
      Freed : System.Address := Null_Address;
      --  The object deallocated last; its first word is the address of the one before

      Bytes : Memory (1 .. Pool_Size);
   end record;

end System.Pool_Size;
