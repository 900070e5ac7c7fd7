--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

with Ada.Unchecked_Conversion;

with Ravenbrick.Failures;
with Ravenbrick.Interrupts;

package body System.Interrupts is

   use Ravenbrick.Registers;

   type Closure is record
      Object : System.Address;
      Code   : System.Address;
   end record;
   --  How the compiler represents an access to a protected procedure

   function To_Closure is new Ada.Unchecked_Conversion (Parameterless_Handler, Closure);

   procedure Install_Restricted_Handlers
     (Prio : Interrupt_Priority; Handlers : New_Handler_Array) is
   begin
      for Item of Handlers loop
         if Is_Reserved (Item.Interrupt) or else Is_Handler_Attached (Item.Interrupt) then
            Ravenbrick.Failures.Stop (Ravenbrick.Failures.Interrupt_Taken'Address);
         end if;
         declare
            Procedure_Of_Object : constant Closure := To_Closure (Item.Handler);
         begin
            Ravenbrick.Interrupts.Attach
              (Source   => Source_Id (Item.Interrupt),
               Priority => Prio,
               Code     => Procedure_Of_Object.Code,
               Object   => Procedure_Of_Object.Object);
         end;
      end loop;
   end Install_Restricted_Handlers;

   function Is_Reserved (Interrupt : Interrupt_ID) return Boolean is
     (Source_Id (Interrupt) = TC0_Id);

   function Is_Handler_Attached (Interrupt : Interrupt_ID) return Boolean is
     (Ravenbrick.Interrupts.Is_Attached (Source_Id (Interrupt)));

end System.Interrupts;
