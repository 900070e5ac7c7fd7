--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts.Names; use Ada.Interrupts.Names;
with Ada.Real_Time; use Ada.Real_Time;
with Ada.Synchronous_Task_Control; use Ada.Synchronous_Task_Control;

with Timers; use Timers;

package body Everything is

   Rung : Suspension_Object;

   protected Mailbox with Priority => 12 is
      procedure Put;
      entry Get;
   private
      Full : Boolean := False;
   end Mailbox;

   protected Bell with Interrupt_Priority => Level is
      procedure Ring with Attach_Handler => TC1;
   end Bell;

   protected body Mailbox is

      procedure Put is
      begin
         Full := True;
      end Put;

      entry Get when Full is
      begin
         Full := False;
      end Get;

   end Mailbox;

   protected body Bell is
      procedure Ring is
      begin
         Acknowledge (Channel_1);
         Set_True (Rung);
      end Ring;
   end Bell;

   task body Cyclic is
      Next : Time := Clock;
   begin
      loop
         Next := Next + Milliseconds (2);
         delay until Next;
         Start_Once (Channel_1, 2_403);
         Mailbox.Put;
      end loop;
   end Cyclic;

   task body Receiver is
   begin
      loop
         Mailbox.Get;
         Turns := Turns + 1;
      end loop;
   end Receiver;

   task body Server is
   begin
      loop
         Suspend_Until_True (Rung);
         Turns := Turns + 1;
      end loop;
   end Server;

end Everything;
