--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Bytes on their way over a link, and numbers made of them, the lowest byte first.

with Ada.Unchecked_Conversion;
with Interfaces;  use Interfaces;

package NXT.Bytes with Pure, SPARK_Mode is

   subtype Byte is Unsigned_8;
   type Byte_Array is array (Positive range <>) of Byte;

   subtype Two_Bytes   is Byte_Array (1 .. 2);
   subtype Four_Bytes  is Byte_Array (1 .. 4);
   subtype Eight_Bytes is Byte_Array (1 .. 8);

   function To_Bytes is new Ada.Unchecked_Conversion (Unsigned_16, Two_Bytes);
   function To_Bytes is new Ada.Unchecked_Conversion (Unsigned_32, Four_Bytes);
   function To_Bytes is new Ada.Unchecked_Conversion (Unsigned_64, Eight_Bytes);
   function To_Word  is new Ada.Unchecked_Conversion (Four_Bytes, Unsigned_32);
   --  The processor's own order is the order on the links.

end NXT.Bytes;
