--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  In Thumb state no instruction reaches the status register: calls of ARM code take its place

package body Ravenbrick.Processor is

   function Mask_And_Report return Status
     with Import, Convention => C, External_Name => "ravenbrick_mask_interrupts";
   procedure Set (Previous : Status)
     with Import, Convention => C, External_Name => "ravenbrick_set_status";
   procedure Exchange (From, To : not null Threads.Thread_Id)
     with Import, Convention => C, External_Name => "ravenbrick_switch";
   procedure Idle (From : not null Threads.Thread_Id)
     with Import, Convention => C, External_Name => "ravenbrick_switch_to_idle";
   procedure Mask with Import, Convention => C, External_Name => "ravenbrick_mask_in_thread";
   procedure Unmask with Import, Convention => C, External_Name => "ravenbrick_unmask_in_thread";

   procedure Mask_Interrupts (Previous : out Status) is
   begin
      Previous := Mask_And_Report;
   end Mask_Interrupts;

   procedure Restore_Interrupts (Previous : Status) is
   begin
      Set (Previous);
   end Restore_Interrupts;

   procedure Mask_In_Thread is
   begin
      Mask;
   end Mask_In_Thread;

   procedure Unmask_In_Thread is
   begin
      Unmask;
   end Unmask_In_Thread;

   procedure Switch (From, To : not null Threads.Thread_Id) is
   begin
      Exchange (From, To);
   end Switch;

   procedure Switch_To_Idle (From : not null Threads.Thread_Id) is
   begin
      Idle (From);
   end Switch_To_Idle;

end Ravenbrick.Processor;
