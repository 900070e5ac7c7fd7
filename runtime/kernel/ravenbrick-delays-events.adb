--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with System;

with Ravenbrick.Alarm;
with Ravenbrick.Clock;

package body Ravenbrick.Delays.Events is

   Expire : Action;

   procedure Ring_With_Events (Unused : System.Address) with Convention => C;
   --  In place of the alarm's handler

   procedure Initialize (Expiry : not null Action) is
   begin
      Expire := Expiry;
      Interrupts.Attach
        (Source   => Registers.TC0_Id,
         Priority => System.Interrupt_Priority'First,
         Code     => Ring_With_Events'Address,
         Object   => System.Null_Address);
   end Initialize;

   procedure Set (Event : not null Thread_Id; Wake : Units) is
   begin
      Event.State := Unstarted;
      Event.Wake := Units'Min (Wake, Units'Last - 1);
      Insert (Event, Clock.Now);
   end Set;

   procedure Cancel (Event : not null Thread_Id) is
      Previous : Thread_Id := Head;
   begin
      if Previous = Event then
         Head := Event.Next;
      else
         while Previous.Next /= Event loop
            Previous := Previous.Next;
         end loop;
         Previous.Next := Event.Next;
      end if;
   end Cancel;

   procedure Ring_With_Events (Unused : System.Address) is
      Now      : Units;
      At_Count : Clock.Count;
      Previous : Processor.Status;
      Sleeper  : Thread_Id;
   begin
      Alarm.Acknowledge;
      Processor.Mask_Interrupts (Previous);
      Clock.Observe (Now, At_Count);
      loop
         Sleeper := Head;
         exit when Sleeper.Wake > Now;
         Head := Sleeper.Next;
         if Sleeper.State = Unstarted then
            Expire (Sleeper, Previous);
         else
            Make_Ready (Sleeper);
            Processor.Restore_Interrupts (Previous);
         end if;
         Processor.Mask_Interrupts (Previous);
      end loop;
      Alarm.Set (Sleeper.Wake - Now - Clock.Since (At_Count), Spent => Spent_In_Ring);
      Processor.Restore_Interrupts (Previous);
   end Ring_With_Events;

end Ravenbrick.Delays.Events;
