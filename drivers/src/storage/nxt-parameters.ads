--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Values that outlive the program, such as calibrations: kept in the last 32 pages (8 KiB) of the
--  flash memory, which images leave free and in which other firmware may have its files.
--
--  A value is saved into the page after the one saved last that holds no current value, so pages
--  age evenly: at 10,000 programmings a page (datasheet, flash characteristics) 32 pages last for
--  about 250,000 savings. The value before stays until the new one is complete: when the supply
--  fails at any moment, the old or the new value is there. A CRC-32 tells complete pages.

package NXT.Parameters with Elaborate_Body is

   type Parameter_Id is range 1 .. 8;
   --  One for each value that a program keeps. Ids belong to the brick, not to the program.

   type Format_Number is range 0 .. 2 ** 16 - 1;

   Maximum_Bytes : constant := 240;

   type Save_Result is (Saved, Memory_Failed);

   generic
      type Value is private;
      Id     : Parameter_Id;
      Format : Format_Number;
   package Store is

      --  Value: without access values, of at most Maximum_Bytes. Format: to be changed with the
      --  meaning of Value; what was saved with another format or of another size is not found.

      procedure Load (Item : in out Value; Found : out Boolean);
      --  Item stays as it is unless Found. Returns at once.

      procedure Save (Item : Value; Result : out Save_Result);
      --  Delays the caller by 7 ms, see also NXT.Flash_Pages; to be called by one task at a time.
      --  Memory_Failed: several pages could not be programmed, the old value stays. A value equal
      --  to that kept is not saved again.

   end Store;

end NXT.Parameters;
