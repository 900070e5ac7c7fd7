--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Interrupts.Names; use Ada.Interrupts.Names;
with System;

with Journal; use Journal;
with Timers; use Timers;

package body Sporadic is

   protected Source with Interrupt_Priority => System.Interrupt_Priority'First + 3 is
      entry Await (Number : out Natural);
      procedure Handle with Attach_Handler => TC1;
   private
      Count    : Natural := 0;
      Occurred : Boolean := False;
   end Source;

   protected body Source is

      entry Await (Number : out Natural) when Occurred is
      begin
         Number := Count;
         Occurred := False;
      end Await;

      procedure Handle is
      begin
         Acknowledge (Channel_1);
         Note ('i');
         Count := Count + 1;
         Occurred := True;
      end Handle;

   end Source;

   task body Server is
      Number : Natural;
   begin
      loop
         Source.Await (Number);
         Note ('s');
         if Number = Served + 1 then
            Served := Number;
         end if;
      end loop;
   end Server;

   Turns : Natural := 0 with Volatile;

   task body Background is
   begin
      Note ('b');
      Start_Cyclic (Channel_1, 24_027);
      loop
         Turns := Turns + 1;
      end loop;
   end Background;

end Sporadic;
