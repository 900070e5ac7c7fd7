--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Storage pools (Ada RM 13.11). Without finalization a pool is a plain tagged type: what it needs
--  at its start are default values of its components.

with System.Storage_Elements;

package System.Storage_Pools is
   pragma Preelaborate;

   type Root_Storage_Pool is abstract tagged limited private;
   pragma Preelaborable_Initialization (Root_Storage_Pool);

   procedure Allocate
     (Pool                     : in out Root_Storage_Pool;
      Storage_Address          : out System.Address;
      Size_In_Storage_Elements : System.Storage_Elements.Storage_Count;
      Alignment                : System.Storage_Elements.Storage_Count)
   is abstract;

   procedure Deallocate
     (Pool                     : in out Root_Storage_Pool;
      Storage_Address          : System.Address;
      Size_In_Storage_Elements : System.Storage_Elements.Storage_Count;
      Alignment                : System.Storage_Elements.Storage_Count)
   is abstract;

   function Storage_Size
     (Pool : Root_Storage_Pool) return System.Storage_Elements.Storage_Count
   is abstract;

private

   type Root_Storage_Pool is abstract tagged limited null record;

   type Root_Storage_Pool_Ptr is access all Root_Storage_Pool'Class;
   for Root_Storage_Pool_Ptr'Storage_Size use 0;

   --  The compiler calls these for pools whose type it does not know

   procedure Allocate_Any
     (Pool                     : in out Root_Storage_Pool'Class;
      Storage_Address          : out System.Address;
      Size_In_Storage_Elements : System.Storage_Elements.Storage_Count;
      Alignment                : System.Storage_Elements.Storage_Count);

   procedure Deallocate_Any
     (Pool                     : in out Root_Storage_Pool'Class;
      Storage_Address          : System.Address;
      Size_In_Storage_Elements : System.Storage_Elements.Storage_Count;
      Alignment                : System.Storage_Elements.Storage_Count);

end System.Storage_Pools;
