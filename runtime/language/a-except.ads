--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Exceptions have no occurrences but Null_Occurrence here: one that no local handler takes
--  reaches the last-chance handler with its place in the source

package Ada.Exceptions is
   pragma Preelaborate;

   type Exception_Id is private;
   pragma Preelaborable_Initialization (Exception_Id);

   Null_Id : constant Exception_Id;

   type Exception_Occurrence is limited private;
   pragma Preelaborable_Initialization (Exception_Occurrence);

   Null_Occurrence : constant Exception_Occurrence;

   procedure Raise_Exception (E : Exception_Id; Message : String := "") with No_Return;
   --  Call the last-chance handler with Message and line 0

private

   type Exception_Data is mod 2 ** 8;
   --  Only its address counts; without elaboration
   type Exception_Id is access all Exception_Data;
   for Exception_Id'Storage_Size use 0;

   Null_Id : constant Exception_Id := null;

   type Exception_Occurrence is limited null record;

   Null_Occurrence : constant Exception_Occurrence := (null record);

   --  What raise statements with a message name the predefined exceptions by

   Constraint_Error_Data : aliased Exception_Data := 0
     with Export, Convention => C, External_Name => "constraint_error";
   Program_Error_Data : aliased Exception_Data := 0
     with Export, Convention => C, External_Name => "program_error";
   Storage_Error_Data : aliased Exception_Data := 0
     with Export, Convention => C, External_Name => "storage_error";
   Tasking_Error_Data : aliased Exception_Data := 0
     with Export, Convention => C, External_Name => "tasking_error";

end Ada.Exceptions;
