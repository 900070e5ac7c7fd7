--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Sizes that the compiler and the binder ask for

package System.Parameters is
   pragma Pure;

   type Size_Type is range -2 ** 31 .. 2 ** 31 - 1;

   Unspecified_Size : constant Size_Type := Size_Type'First;

   Default_Stack_Size_Value : constant Size_Type := 1024;

   function Default_Stack_Size return Size_Type is (Default_Stack_Size_Value);
   --  Bytes of a task without Storage_Size

   function Minimum_Stack_Size return Size_Type is (256);

   function Adjust_Storage_Size (Size : Size_Type) return Size_Type is
     (if Size = Unspecified_Size then Default_Stack_Size_Value
      elsif Size < 256 then 256
      else Size);

   Default_Env_Stack_Size : constant Size_Type := 2048;

   Stack_Grows_Down : constant Boolean := True;

   Runtime_Default_Sec_Stack_Size : constant Size_Type := 512;
   --  Bytes of each task's secondary stack, in programs that use one at all

   Sec_Stack_Dynamic : constant Boolean := False;

   long_bits : constant := 32;
   ptr_bits  : constant := 32;
   subtype C_Address is System.Address;

   C_Malloc_Linkname : constant String := "__gnat_malloc";
   --  What Interfaces.C.Strings allocates with

   Garbage_Collected : constant Boolean := False;
   No_Abort          : constant Boolean := True;

   Max_Task_Image_Length            : constant := 32;
   Default_Exception_Msg_Max_Length : constant := 200;

end System.Parameters;
