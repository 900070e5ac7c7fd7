--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with System.Storage_Elements;

package body Ravenbrick.C_Library is

   use Interfaces.C;
   use System.Storage_Elements;

   Latest_Error : aliased int := 0;

   function String_Length (Text : System.Address) return size_t is
      Length : size_t := 0;
   begin
      loop
         declare
            Item : Storage_Element with Import, Address => Text + Storage_Offset (Length);
         begin
            exit when Item = 0;
         end;
         Length := Length + 1;
      end loop;
      return Length;
   end String_Length;

   function Error_Number return System.Address is (Latest_Error'Address);

end Ravenbrick.C_Library;
