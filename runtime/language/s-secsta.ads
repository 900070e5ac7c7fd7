--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Secondary stacks, for results whose size the caller does not know. The binder allocates one
--  of default size per task in programs that need them; each is one block that cannot grow.

with System.Parameters;
with System.Storage_Elements;

package System.Secondary_Stack is
   pragma Preelaborate;

   package SP renames System.Parameters;
   package SSE renames System.Storage_Elements;


   type SS_Stack (Default_Chunk_Size : SP.Size_Type) is private;

   type SS_Stack_Ptr is access all SS_Stack;

   type Mark_Id is private;

   procedure SS_Init
     (Stack : in out SS_Stack_Ptr; Size : SP.Size_Type := SP.Unspecified_Size);
   --  Empty Stack; when null, take one of the binder's

   procedure SS_Allocate (Addr : out Address; Storage_Size : SSE.Storage_Count);
   --  Reserve Storage_Size bytes on the running task's stack; Storage_Error when it is full

   function SS_Mark return Mark_Id;
   --  The running task's present use

   procedure SS_Release (M : Mark_Id);
   --  Give back what was reserved since M

   function SS_Get_Max return Long_Long_Integer;
   --  Most bytes that the running task ever used

private

   SS_Pool : Integer;
   --  The compiler marks allocations on the secondary stack with this entity

   type Memory is array (SP.Size_Type range <>) of SSE.Storage_Element
     with Alignment => 8;

   type SS_Stack (Default_Chunk_Size : SP.Size_Type) is record
      Used      : SSE.Storage_Count;
      Most_Used : SSE.Storage_Count;
      Bytes     : aliased Memory (1 .. Default_Chunk_Size);
   end record;

   type Mark_Id is new SSE.Storage_Count;

end System.Secondary_Stack;
