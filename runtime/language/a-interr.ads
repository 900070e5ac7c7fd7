--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors
--  SPDX-License-Identifier: Apache-2.0

--  Identification of interrupts (Ada RM C.3.2). Handlers are attached by pragma Attach_Handler
--  only: the profile forbids dynamic attachment, whose operations are absent.

with System.Interrupts;

package Ada.Interrupts is

   type Interrupt_ID is new System.Interrupts.Ada_Interrupt_ID;

   type Parameterless_Handler is access protected procedure;

   function Is_Reserved (Interrupt : Interrupt_ID) return Boolean is
     (System.Interrupts.Is_Reserved (System.Interrupts.Interrupt_ID (Interrupt)));
   --  Whether the run-time keeps the interrupt for itself

   function Is_Attached (Interrupt : Interrupt_ID) return Boolean is
     (System.Interrupts.Is_Handler_Attached (System.Interrupts.Interrupt_ID (Interrupt)));

end Ada.Interrupts;
