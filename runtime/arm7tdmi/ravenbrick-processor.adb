--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with System.Machine_Code; use System.Machine_Code;

package body Ravenbrick.Processor is

   procedure Mask_Interrupts (Previous : out Status) is
      Masked : Status;
   begin
      Asm ("mrs %0, cpsr" & ASCII.LF & ASCII.HT
           & "orr %1, %0, #0x80" & ASCII.LF & ASCII.HT
           & "msr cpsr_c, %1",
           Outputs  => (Status'Asm_Output ("=&r", Previous), Status'Asm_Output ("=r", Masked)),
           Clobber  => "memory",
           Volatile => True);
   end Mask_Interrupts;

   procedure Restore_Interrupts (Previous : Status) is
   begin
      Asm ("msr cpsr_c, %0",
           Inputs   => Status'Asm_Input ("r", Previous),
           Clobber  => "memory",
           Volatile => True);
   end Restore_Interrupts;

   procedure Mask_In_Thread is
   begin
      Asm ("msr cpsr_c, #0xDF", Clobber => "memory", Volatile => True);
   end Mask_In_Thread;

   procedure Unmask_In_Thread is
   begin
      Asm ("msr cpsr_c, #0x5F", Clobber => "memory", Volatile => True);
   end Unmask_In_Thread;

end Ravenbrick.Processor;
