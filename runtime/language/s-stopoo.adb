--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body System.Storage_Pools is

   procedure Allocate_Any
     (Pool                     : in out Root_Storage_Pool'Class;
      Storage_Address          : out System.Address;
      Size_In_Storage_Elements : System.Storage_Elements.Storage_Count;
      Alignment                : System.Storage_Elements.Storage_Count) is
   begin
      Allocate (Pool, Storage_Address, Size_In_Storage_Elements, Alignment);
   end Allocate_Any;

   procedure Deallocate_Any
     (Pool                     : in out Root_Storage_Pool'Class;
      Storage_Address          : System.Address;
      Size_In_Storage_Elements : System.Storage_Elements.Storage_Count;
      Alignment                : System.Storage_Elements.Storage_Count) is
   begin
      Deallocate (Pool, Storage_Address, Size_In_Storage_Elements, Alignment);
   end Deallocate_Any;

end System.Storage_Pools;
