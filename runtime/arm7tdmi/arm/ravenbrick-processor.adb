--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with System;
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
      Asm ("msr cpsr_c, #0x9F", Clobber => "memory", Volatile => True);
   end Mask_In_Thread;

   procedure Unmask_In_Thread is
   begin
      Asm ("msr cpsr_c, #0x1F", Clobber => "memory", Volatile => True);
   end Unmask_In_Thread;

   Line : constant String := ASCII.LF & ASCII.HT;

   --  The offsets are those of layout.h: Stack_Pointer in a thread, Running and Current in the
   --  kernel's state

   procedure Switch (From, To : not null Threads.Thread_Id) is
   begin
      Asm ("adr   r3, 1f" & Line
           & "str   r3, [sp, #-4]!" & Line
           & "str   sp, [%0, #8]" & Line
           & "str   %1, [%2, #0]" & Line
           & "str   %1, [%2, #4]" & Line
           & "ldr   sp, [%1, #8]" & Line
           & "ldr   pc, [sp], #4" & ASCII.LF
           & "1:" & ASCII.HT
           & "msr   cpsr_c, #0x1F",
           Inputs   => (Threads.Thread_Id'Asm_Input ("r", From),
                        Threads.Thread_Id'Asm_Input ("r", To),
                        System.Address'Asm_Input ("r", Threads.Kernel'Address)),
           Clobber  => "r3,r4,r5,r6,r7,r8,r9,r10,r11,r12,lr,cc,memory",
           Volatile => True);
   end Switch;

   procedure Switch_To_Idle (From : not null Threads.Thread_Id) is
   begin
      Asm ("adr   r3, 1f" & Line
           & "str   r3, [sp, #-4]!" & Line
           & "str   sp, [%0, #8]" & Line
           & "b     ravenbrick_idle" & ASCII.LF
           & "1:" & ASCII.HT
           & "msr   cpsr_c, #0x1F",
           Inputs   => Threads.Thread_Id'Asm_Input ("r", From),
           Clobber  => "r3,r4,r5,r6,r7,r8,r9,r10,r11,r12,lr,cc,memory",
           Volatile => True);
   end Switch_To_Idle;

end Ravenbrick.Processor;
