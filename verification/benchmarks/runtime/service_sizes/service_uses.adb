--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Dispatching;
with Ada.Real_Time; use Ada.Real_Time;

package body Service_Uses is

   use Ada.Synchronous_Task_Control;
   use Ada.Real_Time.Timing_Events;

   protected body Plain is
      procedure Count is
      begin
         Value := Value + 1;
      end Count;
   end Plain;

   protected body Guarded is

      procedure Put is
      begin
         Full := True;
      end Put;

      entry Get when Full is
      begin
         Full := False;
      end Get;

   end Guarded;

   protected body Handlers is

      procedure Ring is
      begin
         Set_True (Flag);
      end Ring;

      procedure Expire (Event : in out Timing_Event) is
      begin
         Set_Handler (Event, Clock + Seconds (1), Expire'Access);
      end Expire;

      procedure Tell
        (Cause : Ada.Task_Termination.Cause_Of_Termination;
         T     : Ada.Task_Identification.Task_Id;
         X     : Ada.Exceptions.Exception_Occurrence)
      is
         pragma Unreferenced (Cause, X);
      begin
         Turns := Ada.Task_Identification.Image (T)'Length;
      end Tell;

   end Handlers;

   task body Cyclic is
      Next : Time := Clock;
   begin
      Ada.Task_Termination.Set_Dependents_Fallback_Handler (Handlers.Tell'Access);
      Set_Handler (Event, Seconds (1), Handlers.Expire'Access);
      loop
         Next := Next + Milliseconds (500);
         delay until Next;
         Plain.Count;
         Guarded.Put;
      end loop;
   end Cyclic;

   task body Receiver is
   begin
      loop
         Guarded.Get;
         Ada.Dispatching.Yield;
      end loop;
   end Receiver;

   task body Server is
   begin
      loop
         Suspend_Until_True (Flag);
         Turns := Turns + 1;
      end loop;
   end Server;

end Service_Uses;
