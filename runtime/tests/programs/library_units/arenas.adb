--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

package body Arenas is

   procedure Allocate
     (Pool                     : in out Arena;
      Storage_Address          : out System.Address;
      Size_In_Storage_Elements : Storage_Count;
      Alignment                : Storage_Count)
   is
      pragma Unreferenced (Alignment);
   begin
      Storage_Address := Pool.Block'Address + Pool.Next;
      Pool.Next := Pool.Next + Size_In_Storage_Elements;
   end Allocate;

end Arenas;
