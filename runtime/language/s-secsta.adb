--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Unchecked_Conversion;

with Ravenbrick.Failures;
with Ravenbrick.Threads;

package body System.Secondary_Stack is

   use Ravenbrick.Threads;
   use type SSE.Storage_Offset;

   Default_Size : SP.Size_Type := SP.Runtime_Default_Sec_Stack_Size
     with Export, Convention => C, External_Name => "__gnat_default_ss_size";
   Pool : System.Address := System.Null_Address
     with Export, Convention => C, External_Name => "__gnat_default_ss_pool";
   Pool_Count : Natural := 0
     with Export, Convention => C, External_Name => "__gnat_binder_ss_count";
   --  Written by the binder's code: bytes, address and number of the default-sized stacks

   Taken : Natural := 0;
   --  Stacks of the pool in use

   function To_Stack is new Ada.Unchecked_Conversion (System.Address, SS_Stack_Ptr);

   function Own_Stack return not null SS_Stack_Ptr;
   --  The running task's; Storage_Error when it has none

   function Own_Stack return not null SS_Stack_Ptr is
      Stack : SS_Stack_Ptr := To_Stack (Kernel.Current.Secondary_Stack);
   begin
      if Stack = null then
         SS_Init (Stack);
         Kernel.Current.Secondary_Stack := Stack.all'Address;
      end if;
      return Stack;
   end Own_Stack;

   procedure SS_Init
     (Stack : in out SS_Stack_Ptr; Size : SP.Size_Type := SP.Unspecified_Size)
   is
      pragma Unreferenced (Size);
      subtype Pooled is SS_Stack (Default_Size);
      Bytes_Each : constant SSE.Storage_Offset := Pooled'Object_Size / Storage_Unit;
   begin
      if Stack = null then
         if Taken = Pool_Count then
            Ravenbrick.Failures.Stop (Ravenbrick.Failures.No_Secondary_Stack'Address);
         end if;
         Stack := To_Stack (SSE."+" (Pool, SSE.Storage_Offset (Taken) * Bytes_Each));
         Taken := Taken + 1;
      end if;
      Stack.Used := 0;
      Stack.Most_Used := 0;
   end SS_Init;

   procedure SS_Allocate (Addr : out Address; Storage_Size : SSE.Storage_Count) is
      Alignment : constant := 8;
      Stack     : constant not null SS_Stack_Ptr := Own_Stack;
      Rounded   : constant SSE.Storage_Count :=
        (Storage_Size + Alignment - 1) / Alignment * Alignment;
   begin
      if Rounded > SSE.Storage_Count (Stack.Default_Chunk_Size) - Stack.Used then
         Ravenbrick.Failures.Stop (Ravenbrick.Failures.Secondary_Stack_Full'Address);
      end if;
      Addr := SSE."+" (Stack.Bytes'Address, Stack.Used);
      Stack.Used := Stack.Used + Rounded;
      if Stack.Used > Stack.Most_Used then
         Stack.Most_Used := Stack.Used;
      end if;
   end SS_Allocate;

   function SS_Mark return Mark_Id is (Mark_Id (Own_Stack.Used));

   procedure SS_Release (M : Mark_Id) is
   begin
      Own_Stack.Used := SSE.Storage_Count (M);
   end SS_Release;

   function SS_Get_Max return Long_Long_Integer is (Long_Long_Integer (Own_Stack.Most_Used));

end System.Secondary_Stack;
