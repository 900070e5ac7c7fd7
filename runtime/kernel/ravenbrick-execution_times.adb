--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Interfaces; use Interfaces;

with System;
with System.Storage_Elements; use System.Storage_Elements;

with Ravenbrick.Clock;
with Ravenbrick.Processor;

package body Ravenbrick.Execution_Times is

   type Account is record
      High : Unsigned_16;
      Low  : Unsigned_32;
   end record
     with Volatile, Suppress_Initialization, Size => 64;
   for Account use record
      High at 2 range 0 .. 15;
      Low  at 4 range 0 .. 31;
   end record;
   --  Ticks of the clock, as arm7tdmi/timed/accounting.S counts them

   Offset_In_Thread : constant := 56;

   type Accounts is array (Registers.Source_Id) of Account;

   Of_Handlers : Accounts
     with Import, Convention => C, External_Name => "ravenbrick_handler_accounts";

   procedure Charge_Current
     with Import, Convention => C, External_Name => "ravenbrick_charge_execution_time";

   function To_Units (Item : Account) return Units is
     (Clock.Units_Per_Tick
      * Units (Shift_Left (Unsigned_64 (Item.High), 32) or Unsigned_64 (Item.Low)));

   function Read (Place : System.Address) return Units;
   --  The account at Place with what has passed until now

   function Read (Place : System.Address) return Units is
      Item     : Account with Import, Address => Place;
      Previous : Processor.Status;
      Result   : Units;
   begin
      Processor.Mask_Interrupts (Previous);
      Charge_Current;
      Result := To_Units (Item);
      Processor.Restore_Interrupts (Previous);
      return Result;
   end Read;

   function Of_Thread (Id : not null Threads.Thread_Id) return Units is
     (Read (Id.all'Address + Offset_In_Thread));

   function Of_Source (Source : Registers.Source_Id) return Units is
     (Read (Of_Handlers (Source)'Address));

   function Of_Interrupts return Units is
      Sum : Units := 0;
   begin
      for Source in Registers.Source_Id loop
         Sum := Sum + Of_Source (Source);
      end loop;
      return Sum;
   end Of_Interrupts;

end Ravenbrick.Execution_Times;
