--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Protected procedures as interrupt handlers, attached when their object is elaborated

with Ravenbrick.Registers;

package System.Interrupts is
   pragma Elaborate_Body;

   Default_Interrupt_Priority : constant System.Interrupt_Priority :=
     System.Interrupt_Priority'Last;
   --  Ceiling of an object with Attach_Handler and without Interrupt_Priority (RM D.3 (10))

   type Ada_Interrupt_ID is new Ravenbrick.Registers.Source_Id;

   type Interrupt_ID is new Ravenbrick.Registers.Source_Id;

   subtype System_Interrupt_Id is Interrupt_ID;

   type Parameterless_Handler is access protected procedure;

   type Static_Handler_Index is range 0 .. Integer'Last;
   subtype Positive_Static_Handler_Index is
     Static_Handler_Index range 1 .. Static_Handler_Index'Last;

   type New_Handler_Item is record
      Interrupt : Interrupt_ID;
      Handler   : Parameterless_Handler;
   end record;

   type New_Handler_Array is
     array (Positive_Static_Handler_Index range <>) of New_Handler_Item;

   procedure Install_Restricted_Handlers
     (Prio : Interrupt_Priority; Handlers : New_Handler_Array);
   --  Attach Handlers at Prio, the ceiling of their object. Program_Error for a source that is
   --  reserved or has a handler already.

   function Is_Reserved (Interrupt : Interrupt_ID) return Boolean;
   --  Whether the run-time keeps the source for itself

   function Is_Handler_Attached (Interrupt : Interrupt_ID) return Boolean;

end System.Interrupts;
