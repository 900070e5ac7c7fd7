--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with System;

package body Ada.Exceptions is

   procedure Last_Chance (Message : System.Address; Line : Integer)
     with Import, Convention => C, External_Name => "__gnat_last_chance_handler", No_Return;

   procedure Raise_Exception (E : Exception_Id; Message : String := "") is
      pragma Unreferenced (E);
      Terminated : String (1 .. 64) := (others => ASCII.NUL);
      --  The handler expects a final NUL, and takes no more than fits here
   begin
      for Index in Message'Range loop
         exit when Index - Message'First = Terminated'Last - 1;
         Terminated (Index - Message'First + 1) := Message (Index);
      end loop;
      Last_Chance (Terminated'Address, 0);
   end Raise_Exception;

end Ada.Exceptions;
