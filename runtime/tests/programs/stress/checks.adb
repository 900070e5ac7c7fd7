--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with System.Storage_Elements; use System.Storage_Elements;

package body Checks is

   Interrupt_Mask : Word with Import, Volatile, Address => To_Address (16#FFFF_F110#);

   procedure Hold (Subject : Rule; Condition : Boolean) is
   begin
      if not Condition then
         Violations (Subject) := Violations (Subject) + 1;
      end if;
   end Hold;

   function Enabled return Word is (Interrupt_Mask);

end Checks;
