--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Exceptions;
with Ada.Real_Time; use Ada.Real_Time;
with Ada.Task_Identification; use Ada.Task_Identification;
with Ada.Task_Termination; use Ada.Task_Termination;

with Journal; use Journal;

package body Ending is

   protected Obituaries with Priority => 12 is
      procedure Write
        (Cause : Cause_Of_Termination; T : Task_Id; X : Ada.Exceptions.Exception_Occurrence);
   end Obituaries;

   protected body Obituaries is
      procedure Write
        (Cause : Cause_Of_Termination; T : Task_Id; X : Ada.Exceptions.Exception_Occurrence)
      is
         pragma Unreferenced (X);
      begin
         Note (if Cause = Normal and not Is_Terminated (T) then '+' else '?');
         Note (if T = Short'Identity then 'S' elsif T = Later'Identity then 'L' else '?');
      end Write;
   end Obituaries;

   task body Short is
   begin
      delay until Time_Of (0, Milliseconds (3));
      Note ('s');
   end Short;

   task body Later is
   begin
      delay until Time_Of (0, Milliseconds (5));
      Note ('l');
   end Later;

   task body Endless is
   begin
      loop
         delay until Clock + Milliseconds (40);
         Note (if Is_Terminated (Short'Identity) and Is_Terminated (Later'Identity)
               then 't' else '?');
      end loop;
   end Endless;

begin
   Set_Dependents_Fallback_Handler (Obituaries.Write'Access);
end Ending;
