--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with System.Storage_Elements; use System.Storage_Elements;

with Ravenbrick.Failures;
with Ravenbrick.Processor; use Ravenbrick.Processor;

package body System.Memory is

   Heap      : Storage_Element
     with Import, Convention => C, External_Name => "ravenbrick_heap";
   Heap_Size : Storage_Element
     with Import, Convention => C, External_Name => "ravenbrick_heap_size";
   --  The address is the value: symbols of the linker

   Used : size_t := 0;
   --  Bytes from the beginning

   function Alloc (Size : size_t) return System.Address is
      Alignment : constant := 8;
      Available : constant size_t := size_t (To_Integer (Heap_Size'Address));
      Previous  : Status;
      Offset    : size_t;
   begin
      if Size <= Available then
         Mask_Interrupts (Previous);
         Offset := Used;
         if Size <= Available - Offset then
            Used :=
              size_t'Min (Available, Offset + (Size + Alignment - 1) / Alignment * Alignment);
            Restore_Interrupts (Previous);
            return Heap'Address + Storage_Offset (Offset);
         end if;
      end if;
      Ravenbrick.Failures.Stop (Ravenbrick.Failures.Heap_Full'Address);
   end Alloc;

   procedure Free (Block : System.Address) is null;

end System.Memory;
