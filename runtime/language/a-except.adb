--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with System;

package body Ada.Exceptions is

   procedure Last_Chance (Message : System.Address; Line : Integer)
     with Import, Convention => C, External_Name => "__gnat_last_chance_handler", No_Return;

   Terminated : String (1 .. 64);
   --  The message with the final NUL that the handler expects; static, because the handler takes
   --  a stack that the raiser may have been using

   procedure Raise_Exception (E : Exception_Id; Message : String := "") is
      pragma Unreferenced (E);
      Length : constant Natural := Natural'Min (Message'Length, Terminated'Length - 1);
   begin
      for Index in 1 .. Length loop
         Terminated (Index) := Message (Message'First + Index - 1);
      end loop;
      Terminated (Length + 1) := ASCII.NUL;
      Last_Chance (Terminated'Address, 0);
   end Raise_Exception;

end Ada.Exceptions;
