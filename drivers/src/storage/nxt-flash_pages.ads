--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Programming pages of the processor's flash memory while the program runs. In an image in RAM
--  tasks and interrupts go on meanwhile; in an image in flash the processor waits with interrupts
--  masked, in code that lies in RAM, since the memory cannot be read (AT91SAM7S datasheet, EFC).

with Interfaces;

private package NXT.Flash_Pages is

   subtype Page_Id is Natural range 0 .. 1_023;

   type Page_Content is array (1 .. 64) of Interfaces.Unsigned_32;

   function Content (Page : Page_Id) return Page_Content;

   procedure Program (Page : Page_Id; Content : Page_Content; Done : out Boolean);
   --  Erase and program a page, unlocking its region if needed, and compare. Delays the caller by
   --  7 ms, 11 ms with unlocking; an image in flash is held for 6 and 9 ms. By one task at a time.

   subtype Bit_Id is Natural range 0 .. 1;

   function Bit_Is_Set (Number : Bit_Id) return Boolean;

   procedure Set_Bit (Number : Bit_Id);
   --  A general purpose bit, which outlives the program: delays the caller by 4 ms unless it is
   --  set already; an image in flash is held for 3 ms. By the task that programs pages.

end NXT.Flash_Pages;
