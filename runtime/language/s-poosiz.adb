--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ravenbrick.Failures;

package body System.Pool_Size is

   use SSE;

   Word : constant Storage_Count := System.Address'Size / Storage_Unit;

   function Is_Reused (Pool : Stack_Bounded_Pool) return Boolean is
     (Pool.Elmt_Size >= Word and then Pool.Alignment mod Word = 0);
   --  Whether an object can hold an address while it is deallocated

   procedure Allocate
     (Pool         : in out Stack_Bounded_Pool;
      Address      : out System.Address;
      Storage_Size : Storage_Count;
      Alignment    : Storage_Count)
   is
      Place : constant System.Address := Pool.Bytes'Address + Pool.Used;
      Skip  : constant Storage_Count :=
        (if Alignment > 1 then (Alignment - Place mod Alignment) mod Alignment else 0);
   begin
      if Pool.Freed /= Null_Address then
         declare
            Following : System.Address with Import, Address => Pool.Freed;
         begin
            Address := Pool.Freed;
            Pool.Freed := Following;
         end;
      elsif Skip + Storage_Size <= Pool.Pool_Size - Pool.Used then
         Address := Place + Skip;
         Pool.Used := Pool.Used + Skip + Storage_Size;
      else
         Ravenbrick.Failures.Stop (Ravenbrick.Failures.Pool_Full'Address);
      end if;
   end Allocate;

   procedure Deallocate
     (Pool         : in out Stack_Bounded_Pool;
      Address      : System.Address;
      Storage_Size : Storage_Count;
      Alignment    : Storage_Count)
   is
      pragma Unreferenced (Storage_Size, Alignment);
      Following : System.Address with Import, Address => Address;
   begin
      if Is_Reused (Pool) then
         Following := Pool.Freed;
         Pool.Freed := Address;
      end if;
   end Deallocate;

end System.Pool_Size;
