--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  A storage pool of a program's own: one block that only grows

with System.Storage_Elements; use System.Storage_Elements;
with System.Storage_Pools;    use System.Storage_Pools;

package Arenas is

   type Arena (Size : Storage_Count) is new Root_Storage_Pool with private;

   overriding procedure Allocate
     (Pool                     : in out Arena;
      Storage_Address          : out System.Address;
      Size_In_Storage_Elements : Storage_Count;
      Alignment                : Storage_Count);

   overriding procedure Deallocate
     (Pool                     : in out Arena;
      Storage_Address          : System.Address;
      Size_In_Storage_Elements : Storage_Count;
      Alignment                : Storage_Count) is null;

   overriding function Storage_Size (Pool : Arena) return Storage_Count is (Pool.Size);

   subtype Bytes is Storage_Count;

   function Used (Pool : Arena) return Bytes;

private

   type Arena (Size : Storage_Count) is new Root_Storage_Pool with record
      Next  : Storage_Count := 0;
      Block : Storage_Array (1 .. Size);
   end record;

   function Used (Pool : Arena) return Bytes is (Pool.Next);

end Arenas;
