--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  One use of each service of the run-time; footprints.py reads its sizes

with Ada.Exceptions;
with Ada.Synchronous_Task_Control;
with Ada.Real_Time.Timing_Events;
with Ada.Task_Identification;
with Ada.Task_Termination;
with System;

package Service_Uses is

   Turns : Natural := 0 with Volatile;

   protected Plain with Priority => 12 is
      procedure Count;
   private
      Value : Natural := 0;
   end Plain;

   protected Guarded with Priority => 12 is
      procedure Put;
      entry Get;
   private
      Full : Boolean := False;
   end Guarded;

   protected Handlers with Interrupt_Priority => System.Interrupt_Priority'First + 3 is
      procedure Ring with Attach_Handler => 13;
      procedure Expire (Event : in out Ada.Real_Time.Timing_Events.Timing_Event);
      procedure Tell
        (Cause : Ada.Task_Termination.Cause_Of_Termination;
         T     : Ada.Task_Identification.Task_Id;
         X     : Ada.Exceptions.Exception_Occurrence);
   end Handlers;

   Flag  : Ada.Synchronous_Task_Control.Suspension_Object;
   Event : Ada.Real_Time.Timing_Events.Timing_Event;

   task Cyclic with Priority => 10, Storage_Size => 512;
   task Receiver with Priority => 12, Storage_Size => 512;
   task Server with Priority => 14, Storage_Size => 512;

end Service_Uses;
