--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Flash and its controller (datasheet, chapter EFC): pages of 256 bytes. Words written to a page
--  wait in a buffer until the command that programs the page, which erases it first.

with System;

package NXT.Registers.EFC is

   type Peripheral is record
      MC_FCR : Word with Atomic;  --  command
      MC_FSR : Word with Atomic;  --  status
   end record;

   for Peripheral use record
      MC_FCR at 16#64# range 0 .. 31;
      MC_FSR at 16#68# range 0 .. 31;
   end record;

   EFC : Peripheral with Import, Volatile, Address => System'To_Address (16#FFFF_FF00#);

   --  MC_FCR: key, page number from bit 8 on, what to do
   Write_Page   : constant Word := 16#5A00_0001#;  --  WP
   Clear_Lock   : constant Word := 16#5A00_0004#;  --  CLB
   Set_Bit      : constant Word := 16#5A00_000B#;  --  SGPB
   --  With the number of a general purpose bit in the place of the page.
   Page_Place   : constant := 8;

   --  MC_FSR
   Ready      : constant Word := Bit (0);  --  FRDY
   First_Lock : constant := 16;
   --  Number of the bit of the first lock region.
   First_Bit  : constant := 8;
   --  Number of the first general purpose bit.

   --  General purpose bits
   Detect_Brown_Out   : constant := 0;
   Reset_At_Brown_Out : constant := 1;

   Start_Address : constant := 16#0010_0000#;
   Page_Length   : constant := 256;
   Region_Pages  : constant := 64;

end NXT.Registers.EFC;
